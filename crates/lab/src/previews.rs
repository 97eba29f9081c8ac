//! Scenes of all experiments for the gallery, made one after the other on a thread of their own.

use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use corpuscle_experiments::Experiment;
use corpuscle_io::Scenario;
use corpuscle_scene::Scene;

/// Longest time spent on one experiment after its start.
const PATIENCE: Duration = Duration::from_millis(1500);
/// How far into an experiment its picture is taken, where patience lasts.
const PART: f64 = 0.35;
/// Looks on the way, for the trails.
const LOOKS: u32 = 120;

/// The scenes there are so far.
#[derive(Default)]
pub struct Previews {
    scenes: Vec<Option<Scene>>,
    coming: Option<Receiver<(usize, Scene)>>,
}

impl Previews {
    /// None at all, and none to come.
    pub fn none() -> Self {
        Self::default()
    }

    /// Begins to make a scene of each experiment; `wake` is called when there is another.
    pub fn begin(registry: &[&'static Experiment], wake: impl Fn() + Send + 'static) -> Self {
        let (sender, receiver) = channel();
        let experiments = registry.to_vec();
        // Without a thread the gallery has no pictures, and no more.
        let _ = thread::Builder::new().name("gallery".into()).spawn(move || {
            for (index, experiment) in experiments.into_iter().enumerate() {
                if let Some(scene) = scene_of(experiment, PATIENCE)
                    && sender.send((index, scene)).is_err()
                {
                    return;
                }
                wake();
            }
        });
        Self { scenes: vec![None; registry.len()], coming: Some(receiver) }
    }

    /// Makes all of them now, as far as patience lasts nowhere: for pictures, which are to be the same again.
    pub fn all(registry: &[&'static Experiment]) -> Self {
        let scenes = registry.iter().map(|experiment| scene_of(experiment, Duration::MAX)).collect();
        Self { scenes, coming: None }
    }

    /// Takes in what has been made.
    pub fn refresh(&mut self) {
        if let Some(coming) = &self.coming {
            while let Ok((index, scene)) = coming.try_recv() {
                self.scenes[index] = Some(scene);
            }
        }
    }

    /// The scene of an experiment, once there is one.
    pub fn scene(&self, index: usize) -> Option<&Scene> {
        self.scenes.get(index)?.as_ref()
    }
}

fn scene_of(experiment: &'static Experiment, patience: Duration) -> Option<Scene> {
    let scenario = Scenario::new(experiment);
    let mut simulation = scenario.start().ok()?;
    let (start, began) = (simulation.time(), Instant::now());
    let end = start + PART * (simulation.end() - start);
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    for look in 1..=LOOKS {
        if began.elapsed() > patience || simulation.advance(start + (end - start) * f64::from(look) / f64::from(LOOKS)).is_err() {
            break;
        }
        simulation.draw(&mut scene);
    }
    Some(scene)
}

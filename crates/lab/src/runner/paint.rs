//! What the bodies' colours tell, where a person asks for something else than the experiment does.

use corpuscle_scene::{Colour, Colouring, Scene};

use crate::language::Text;
use crate::tools::state_of;

/// What the colours of the bodies tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Paint {
    /// What the experiment chooses.
    #[default]
    Own,
    /// Their speeds.
    Speed,
    /// Nothing: all are alike.
    Plain,
}

/// Upper end of the scale over the root mean square speed: 1 body in 500 of a gas in the plane is faster.
const SCALE: f64 = 2.5;

impl Paint {
    /// Its name.
    pub fn text(self) -> Text {
        match self {
            Self::Own => Text::PaintOwn,
            Self::Speed => Text::PaintSpeed,
            Self::Plain => Text::PaintPlain,
        }
    }

    /// The next one round.
    #[must_use]
    pub fn next(self) -> Self {
        match self {
            Self::Own => Self::Speed,
            Self::Speed => Self::Plain,
            Self::Plain => Self::Own,
        }
    }

    /// Gives a scene these colours. `most` is the upper end of the scale of speeds, which is found at the first look and kept, so
    /// that colours mean the same as long as the run lasts.
    pub(super) fn apply(self, scene: &mut Scene, most: &mut Option<f64>) {
        match self {
            Self::Own => {}
            Self::Plain => scene.colouring = Colouring::Uniform(Colour::Accent(0)),
            Self::Speed => {
                let most = *most.get_or_insert_with(|| SCALE * root_mean_square_speed(scene));
                scene.colouring = Colouring::Speed { most, unit: String::new() };
            }
        }
    }
}

fn root_mean_square_speed(scene: &Scene) -> f64 {
    let squares: f64 = scene.bodies.iter().map(|body| state_of(body, scene).1.iter().map(|v| v * v).sum::<f64>()).sum();
    let mean = squares / scene.bodies.len().max(1) as f64;
    // At rest every speed is at the lower end.
    if mean > 0.0 { mean.sqrt() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_scene::Body;

    #[test]
    fn the_scale_of_speeds_is_found_once() {
        let at = |speed: f64| Body { velocity: [speed, 0.0, 0.0], ..Body::default() };
        let mut scene = Scene { bodies: vec![at(3.0), at(-3.0)], ..Scene::default() };
        let mut most = None;
        Paint::Speed.apply(&mut scene, &mut most);
        assert_eq!(scene.colouring, Colouring::Speed { most: 7.5, unit: String::new() });
        scene.bodies = vec![at(1.0)];
        Paint::Speed.apply(&mut scene, &mut most);
        assert_eq!(most, Some(7.5));
    }
}

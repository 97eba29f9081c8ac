//! What the bodies' colours tell, where a person asks for something else than the experiment does.

use corpuscle_scene::{Camera, Colour, Colouring, Scene, Shade};
use serde::{Deserialize, Serialize};

use crate::language::Text;
use crate::number::one_two_five_below;
use crate::tools::state_of;

/// What the colours of the bodies tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Paint {
    /// What the experiment chooses.
    #[default]
    Own,
    /// Their speeds.
    Speed,
    /// Their kinetic energies.
    Energy,
    /// Their species.
    Species,
    /// How often they have collided.
    Collisions,
    /// How high they are.
    Height,
    /// Nothing: all are alike.
    Plain,
}

/// Upper end of the scale of speeds over the root mean square: 1 body in 500 of a gas in the plane is faster.
const FASTEST: f64 = 2.5;
/// The same of kinetic energies over their mean: 1 in 50 has more.
const LIVELIEST: f64 = 4.0;

impl Paint {
    /// All of them.
    pub const ALL: [Self; 7] = [Self::Own, Self::Speed, Self::Energy, Self::Species, Self::Collisions, Self::Height, Self::Plain];

    /// Its name.
    pub fn text(self) -> Text {
        match self {
            Self::Own => Text::PaintOwn,
            Self::Speed => Text::PaintSpeed,
            Self::Energy => Text::PaintEnergy,
            Self::Species => Text::PaintSpecies,
            Self::Collisions => Text::PaintCollisions,
            Self::Height => Text::PaintHeight,
            Self::Plain => Text::PaintPlain,
        }
    }

    /// The next one round.
    #[must_use]
    pub fn next(self) -> Self {
        let place = Self::ALL.iter().position(|&paint| paint == self).unwrap_or(0);
        Self::ALL[(place + 1) % Self::ALL.len()]
    }

    /// What the bodies' shade has to hold for it.
    pub(super) fn wanted(self) -> Shade {
        match self {
            Self::Energy => Shade::Mass,
            Self::Species => Shade::Species,
            Self::Collisions => Shade::Collisions,
            Self::Own | Self::Speed | Self::Height | Self::Plain => Shade::Own,
        }
    }

    /// Whether a scene drawn for it tells what it needs.
    pub fn is_known(self, scene: &Scene) -> bool {
        self.wanted() == scene.shaded || self == Self::Species && matches!(scene.colouring, Colouring::Species(_))
    }

    /// Gives a scene these colours; where it does not tell what they need, it keeps its own. `ends` of the scale are found at
    /// the first look and kept, so that colours mean the same as long as the run lasts; of counts, which grow, they follow.
    pub(super) fn apply(self, scene: &mut Scene, ends: &mut Option<[f64; 2]>) {
        if !self.is_known(scene) {
            return;
        }
        match self {
            Self::Own => {}
            Self::Plain => scene.colouring = Colouring::Uniform(Colour::Accent(0)),
            Self::Speed => {
                let [_, most] = *ends.get_or_insert_with(|| [0.0, FASTEST * mean(scene, |_, v2| v2).sqrt()]);
                scene.colouring = Colouring::Speed { most: above_zero(most), unit: String::new() };
            }
            Self::Energy => {
                let [_, most] = *ends.get_or_insert_with(|| [0.0, LIVELIEST * mean(scene, |mass, v2| 0.5 * mass * v2)]);
                scene.colouring = Colouring::Energy { most: above_zero(most) };
            }
            Self::Species => {
                if !matches!(scene.colouring, Colouring::Species(_)) {
                    let kinds = scene.bodies.iter().map(|body| body.shade).fold(0.0, f64::max) as usize + 1;
                    scene.colouring = Colouring::Species((1..=kinds).map(|kind| kind.to_string()).collect());
                }
            }
            Self::Collisions => {
                let counts = || scene.bodies.iter().map(|body| body.shade);
                let (least, most) = counts().fold((f64::INFINITY, 0.0f64), |(a, b), n| (a.min(n), b.max(n)));
                let least = if least.is_finite() { least } else { 0.0 };
                // Round ends, so that the scale moves now and then and not all the time.
                let step = one_two_five_below((0.5 * (most - least)).max(1.0));
                let [least, most] = [(least / step).floor() * step, (most / step).ceil().max(1.0) * step];
                scene.colouring =
                    Colouring::Value { name: "collisions".into(), unit: String::new(), least, most: most.max(least + 1.0) };
            }
            Self::Height => {
                let axis = if matches!(scene.camera, Camera::Plane { .. }) { 1 } else { 2 };
                let [least, most] = *ends.get_or_insert_with(|| heights(scene, axis));
                scene.colouring = Colouring::Height { axis, least, most };
            }
        }
    }
}

/// At rest every value is at the lower end.
fn above_zero(most: f64) -> f64 {
    if most > 0.0 { most } else { 1.0 }
}

/// Mean over all bodies of a function of their shade and the square of their speed.
fn mean(scene: &Scene, of: impl Fn(f64, f64) -> f64) -> f64 {
    let values = scene.bodies.iter().map(|body| of(body.shade, state_of(body, scene).1.iter().map(|v| v * v).sum()));
    values.sum::<f64>() / scene.bodies.len().max(1) as f64
}

/// The box's extent along an axis, or the bodies' where there is no box.
fn heights(scene: &Scene, axis: usize) -> [f64; 2] {
    if let Some([lower, upper]) = scene.bounds {
        return [lower[axis], upper[axis]];
    }
    let places = scene.bodies.iter().map(|body| state_of(body, scene).0[axis]);
    let (least, most) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    if least < most { [least, most] } else { [0.0, 1.0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corpuscle_scene::Body;

    fn at(speed: f64) -> Body {
        Body { velocity: [speed, 0.0, 0.0], shade: 2.0, ..Body::default() }
    }

    #[test]
    fn the_scale_of_speeds_is_found_once() {
        let mut scene = Scene { bodies: vec![at(3.0), at(-3.0)], ..Scene::default() };
        let mut ends = None;
        Paint::Speed.apply(&mut scene, &mut ends);
        assert_eq!(scene.colouring, Colouring::Speed { most: 7.5, unit: String::new() });
        scene.bodies = vec![at(1.0)];
        Paint::Speed.apply(&mut scene, &mut ends);
        assert_eq!(scene.colouring, Colouring::Speed { most: 7.5, unit: String::new() });
    }

    #[test]
    fn what_the_scene_does_not_tell_is_not_claimed() {
        let own = Colouring::Uniform(Colour::Ink);
        let mut scene = Scene { bodies: vec![at(3.0)], colouring: own.clone(), ..Scene::default() };
        for paint in [Paint::Energy, Paint::Collisions, Paint::Species] {
            paint.apply(&mut scene, &mut None);
            assert_eq!(scene.colouring, own, "{paint:?}");
        }
        scene.shaded = Shade::Mass;
        Paint::Energy.apply(&mut scene, &mut None);
        assert_eq!(scene.colouring, Colouring::Energy { most: 36.0 });
    }

    #[test]
    fn counts_have_round_ends() {
        let count = |n: f64| Body { shade: n, ..Body::default() };
        let mut scene = Scene { bodies: vec![count(31.0), count(58.0)], shaded: Shade::Collisions, ..Scene::default() };
        Paint::Collisions.apply(&mut scene, &mut None);
        let Colouring::Value { least, most, .. } = scene.colouring else { panic!("another colouring") };
        assert_eq!([least, most], [30.0, 60.0]);
    }

    #[test]
    fn all_are_gone_through() {
        let mut paint = Paint::Own;
        for _ in Paint::ALL {
            paint = paint.next();
        }
        assert_eq!(paint, Paint::Own);
    }
}

//! The rules of collision of a free system.

use corpuscle_core::Invalid;
use corpuscle_event::{Pair, Restitution, Rules};

use super::{field, not_negative, positive};
use crate::free::spec::{Collisions, System};

/// Restitution, law of pairs, field and seed as the file has them.
pub(super) fn rules<const D: usize>(system: &System, seed: u64) -> Result<Rules<D>, Invalid> {
    let mut rules = Rules { field: field(system)?, seed, ..Rules::default() };
    if let Some(given) = &system.collisions {
        not_negative("collisions.elastic_below", given.elastic_below)?;
        (rules.restitution, rules.pair, rules.elastic_below) = (restitution(given)?, pair(given)?, given.elastic_below);
    }
    rules.validate().map_err(|error| Invalid { key: format!("collisions.{}", error.key), ..error })?;
    Ok(rules)
}

fn restitution(given: &Collisions) -> Result<Restitution, Invalid> {
    match (given.restitution, &given.viscoelastic) {
        (constant, None) => Ok(constant.unwrap_or(1.0).into()),
        (None, Some(material)) => {
            let (stiffness, dissipation_time) = (material.stiffness, material.dissipation_time);
            positive("collisions.viscoelastic.stiffness", stiffness)?;
            not_negative("collisions.viscoelastic.dissipation_time", dissipation_time)?;
            Ok(Restitution::Viscoelastic { stiffness, dissipation_time })
        }
        (Some(_), Some(_)) => {
            Err(Invalid::new("collisions.viscoelastic", "given", "nothing beside restitution: one law of the two"))
        }
    }
}

fn pair(given: &Collisions) -> Result<Pair, Invalid> {
    let law = |key: &str, range: f64, energy: &str, height: f64, depth: f64| {
        if !(range > 1.0 && range.is_finite()) {
            let expected = "a number above 1, in contact distances";
            return Err(Invalid::new(format!("collisions.{key}.range"), range, expected));
        }
        positive(&format!("collisions.{key}.{energy}"), height)?;
        Ok(Pair::Well { range, depth })
    };
    match (&given.well, &given.shoulder) {
        (None, None) => Ok(Pair::Hard),
        (Some(well), None) => law("well", well.range, "depth", well.depth, well.depth),
        (None, Some(shoulder)) => law("shoulder", shoulder.range, "height", shoulder.height, -shoulder.height),
        (Some(_), Some(_)) => Err(Invalid::new("collisions.shoulder", "given", "nothing beside a well: one law of the two")),
    }
}

//! Bonds of a free system, every number checked.

use corpuscle_core::Invalid;
use corpuscle_time::{BondLaw, Bonds, FiniteExtension, Force, Spring, Springs, Toda};

use super::soft::Named;
use super::{finite, not_negative, positive};
use crate::free::spec::System;

/// All forces of bonds between so many particles.
pub(super) fn forces<const D: usize>(system: &System, particles: usize) -> Result<Vec<Named<D>>, Invalid> {
    let mut forces: Vec<Named<D>> = vec![];
    if !system.springs.is_empty() {
        forces.push(("spring", Box::new(Springs::new(springs(system, particles)?))));
    }
    let mut laws: Vec<(FiniteExtension, Vec<(usize, usize)>)> = vec![];
    for (index, bond) in system.finite.iter().enumerate() {
        let key = |field: &str| format!("fene[{index}].{field}");
        positive(&key("stiffness"), bond.stiffness)?;
        positive(&key("longest"), bond.longest)?;
        let row = row(&key, [bond.first, bond.second], bond.count, particles)?;
        add(&mut laws, FiniteExtension { stiffness: bond.stiffness, longest: bond.longest }, row);
    }
    forces.extend(laws.into_iter().map(|(law, ends)| ("fene", Box::new(Bonds::new(law, ends)) as Box<dyn Force<D>>)));
    let mut laws: Vec<(Toda, Vec<(usize, usize)>)> = vec![];
    for (index, bond) in system.exponential.iter().enumerate() {
        let key = |field: &str| format!("toda[{index}].{field}");
        positive(&key("stiffness"), bond.stiffness)?;
        positive(&key("steepness"), bond.steepness)?;
        positive(&key("rest_length"), bond.rest_length)?;
        let row = row(&key, [bond.first, bond.second], bond.count, particles)?;
        let law = Toda { stiffness: bond.stiffness, steepness: bond.steepness, rest_length: bond.rest_length };
        add(&mut laws, law, row);
    }
    forces.extend(laws.into_iter().map(|(law, ends)| ("toda", Box::new(Bonds::new(law, ends)) as Box<dyn Force<D>>)));
    Ok(forces)
}

/// Bonds of one law are one force.
fn add<L: BondLaw + PartialEq>(laws: &mut Vec<(L, Vec<(usize, usize)>)>, law: L, row: Vec<(usize, usize)>) {
    match laws.iter_mut().find(|(known, _)| *known == law) {
        Some((_, ends)) => ends.extend(row),
        None => laws.push((law, row)),
    }
}

/// Key of the first table of bonds, if there are any.
pub(super) fn first_key(system: &System) -> Option<&'static str> {
    let tables = [
        ("spring[0]", system.springs.is_empty()),
        ("fene[0]", system.finite.is_empty()),
        ("toda[0]", system.exponential.is_empty()),
    ];
    tables.into_iter().find(|(_, empty)| !empty).map(|(key, _)| key)
}

/// Key of the table that a bond comes from, by its number among all of its kind: a table may be a row of them.
pub(super) fn key_of(system: &System, kind: &str, number: &str) -> String {
    let counts: Vec<usize> = match kind {
        "spring" => system.springs.iter().map(|bond| bond.count).collect(),
        "fene" => system.finite.iter().map(|bond| bond.count).collect(),
        _ => system.exponential.iter().map(|bond| bond.count).collect(),
    };
    let (number, mut end) = (number.parse().unwrap_or(0), 0);
    let table = counts.iter().position(|count| {
        end += count;
        number < end
    });
    format!("{kind}[{}]", table.unwrap_or(0))
}

/// Ends of all bonds, for pictures.
pub(super) fn all_ends(system: &System) -> Vec<[usize; 2]> {
    let springs = system.springs.iter().map(|bond| (bond.first, bond.second, bond.count));
    let finite = system.finite.iter().map(|bond| (bond.first, bond.second, bond.count));
    let exponential = system.exponential.iter().map(|bond| (bond.first, bond.second, bond.count));
    springs
        .chain(finite)
        .chain(exponential)
        .flat_map(|(first, second, count)| (0..count).map(move |n| [first + n, second + n]))
        .collect()
}

fn springs(system: &System, particles: usize) -> Result<Vec<Spring>, Invalid> {
    let mut springs = vec![];
    for (index, bond) in system.springs.iter().enumerate() {
        let key = |field: &str| format!("spring[{index}].{field}");
        not_negative(&key("stiffness"), bond.stiffness)?;
        not_negative(&key("rest_length"), bond.rest_length)?;
        not_negative(&key("damping"), bond.damping)?;
        finite(&key("quadratic"), bond.quadratic)?;
        finite(&key("cubic"), bond.cubic)?;
        for (first, second) in row(&key, [bond.first, bond.second], bond.count, particles)? {
            springs.push(Spring {
                damping: bond.damping,
                quadratic: bond.quadratic,
                cubic: bond.cubic,
                ..Spring::new(first, second, bond.stiffness, bond.rest_length)
            });
        }
    }
    Ok(springs)
}

/// Ends of a row of bonds, each between the particles after those of the one before.
fn row(
    key: &impl Fn(&str) -> String,
    [first, second]: [usize; 2],
    count: usize,
    particles: usize,
) -> Result<Vec<(usize, usize)>, Invalid> {
    for (field, end) in [("first", first), ("second", second)] {
        if end >= particles {
            return Err(Invalid::new(key(field), end, format!("the index of a particle, 0 to {}", particles - 1)));
        }
    }
    if first == second {
        return Err(Invalid::new(key("second"), second, "another particle than the first"));
    }
    let most = particles - first.max(second);
    if !(1..=most).contains(&count) {
        return Err(Invalid::new(key("count"), count, format!("1 to {most}: the last bond ends at the last particle")));
    }
    Ok((0..count).map(|n| (first + n, second + n)).collect())
}

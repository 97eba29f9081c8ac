#![allow(clippy::unwrap_used)] // a test that cannot go on has failed

use std::io::Cursor;

use corpuscle_core::{Particles, Vector};
use corpuscle_experiments::Frame;

use crate::trajectory::{Format, ReadError, Snapshot};
use crate::{dump, xyz};

/// Particles whose numbers have many digits, in two species.
fn gas(time: f64, dimension: usize) -> Frame {
    let mut particles = Particles::<3>::new();
    for i in 0..50 {
        let x = f64::from(i).sqrt();
        let place = [x, 1.0 / (1.0 + x), if dimension == 3 { x.ln_1p() } else { 0.0 }];
        let velocity = [-x * 1e-300, x * 1e17, if dimension == 3 { -0.0 } else { 0.0 }];
        particles.push(Vector(place), Vector(velocity), 1.0 + x, 0.1 * x, u16::from(i % 3 == 0));
    }
    let names = ["bath", "heavy"].map(String::from).to_vec();
    Frame { time, dimension, lower: [-1.0, 0.0, -0.5], upper: [8.0, 1.0, 0.5], periodic: [true, false, false], names, particles }
}

fn read(format: Format, text: &str, frame: Option<u64>) -> Result<Snapshot, ReadError> {
    format.read(Cursor::new(text), frame)
}

/// What was written is read to the last bit, by number and from the end.
#[test]
fn what_is_written_is_read() {
    for dimension in [2, 3] {
        let frames: Vec<Frame> = (0..4).map(|k| gas(f64::from(k) / 3.0, dimension)).collect();
        let text: String = frames.iter().map(xyz::frame).collect();
        let lammps: String = frames.iter().zip(0..).map(|(frame, number)| dump::frame(frame, number)).collect();
        for (format, text) in [(Format::Xyz, text), (Format::Dump, lammps)] {
            for (wanted, frame) in [(Some(0), &frames[0]), (Some(2), &frames[2]), (None, &frames[3])] {
                let found = read(format, &text, wanted).unwrap();
                assert_eq!(found.time, Some(frame.time));
                let Particles { position, velocity, mass, radius, .. } = frame.particles.clone();
                assert_eq!(found.position, position);
                assert_eq!((found.velocity, found.mass, found.radius), (Some(velocity), Some(mass), Some(radius)));
                let names = (0..50).map(|i| found.names[usize::from(found.species[i])].clone());
                let expected = |i| {
                    if format == Format::Dump { format!("type {}", frame.particles.species[i] + 1) } else { frame.name(i).into() }
                };
                assert!(names.enumerate().all(|(i, name)| name == expected(i)));
            }
            assert!(matches!(read(format, &text, Some(4)), Err(ReadError::TooShort(4))));
        }
    }
}

/// Wherever a file is cut off: the last whole frame is read, or the file is refused; never half a frame, never half a number.
#[test]
fn a_file_cut_off_anywhere_gives_whole_frames() {
    let frames: Vec<Frame> = (0..3).map(|k| gas(f64::from(k), 2)).collect();
    for (format, texts) in [
        (Format::Xyz, frames.iter().map(xyz::frame).collect::<Vec<_>>()),
        (Format::Dump, frames.iter().zip(0..).map(|(frame, number)| dump::frame(frame, number)).collect()),
    ] {
        let (whole, two) = (texts.concat(), texts[..2].concat().len());
        for length in 0..whole.len() {
            let found = read(format, &whole[..length], None);
            let expected = if length < texts[0].len() { None } else { Some(if length < two { 0.0 } else { 1.0 }) };
            assert_eq!(found.ok().map(|snapshot| snapshot.time.unwrap()), expected, "{length} bytes");
        }
    }
}

#[test]
fn files_of_other_programs() {
    // As ASE writes it.
    let text = "2\nLattice=\"5.0 0.0 0.0 0.0 5.0 0.0 0.0 0.0 5.0\" Properties=species:S:1:pos:R:3:forces:R:3 pbc=\"T T T\"\n\
                Ar 1.0 2.0 3.0 0 0 0\nNe   4.0 2.5 3e-1  0 0 0\n";
    let found = read(Format::Xyz, text, None).unwrap();
    assert_eq!(found.position, [Vector([1.0, 2.0, 3.0]), Vector([4.0, 2.5, 0.3])]);
    assert_eq!((found.names, found.species), (vec!["Ar".to_owned(), "Ne".into()], vec![0, 1]));
    assert_eq!((found.velocity, found.mass, found.radius), (None, None, None));
    // Plain XYZ.
    assert_eq!(read(Format::Xyz, "1\nwater\nO 1 2 3\n\n", None).unwrap().position, [Vector([1.0, 2.0, 3.0])]);
    // As LAMMPS writes it: scaled, in any order, with columns of its own.
    let text = "ITEM: UNITS\nlj\nITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n-1.0e+00 3.0\n0 2\n-0.5 0.5\n\
                ITEM: ATOMS id type xs ys zs vx vy vz c_pe diameter\n7 2 0.5 0.25 0.5 1 2 3 -4 1.5\n3 1 0 1 0.5 0 0 0 0 1\n";
    let found = read(Format::Dump, text, None).unwrap();
    assert_eq!(found.position, [Vector([-1.0, 2.0, 0.0]), Vector([1.0, 0.5, 0.0])]);
    assert_eq!(found.velocity.unwrap()[1], Vector([1.0, 2.0, 3.0]));
    assert_eq!(found.radius, Some(vec![0.5, 0.75]));
    assert_eq!((found.names, found.species), (vec!["type 1".to_owned(), "type 2".into()], vec![0, 1]));
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    let dump = "ITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS xy xz yz pp pp pp\n0 1 0\n0 1 0\n0 1 0\nITEM: ATOMS";
    let cases = [
        (Format::Xyz, "two\n".to_owned(), "line 1: `two`: expected a number of particles"),
        (Format::Xyz, "99999999999\n".into(), "line 1: `99999999999`: expected a number of particles, from 1 to 2000000"),
        (Format::Xyz, "1\n\nH 1 2\n".into(), "line 3: `H 1 2`: expected 4 columns"),
        (Format::Xyz, "1\n\nH 1 2 nan\n".into(), "line 3: `nan`: expected a finite number"),
        (Format::Xyz, "1\nProperties=pos:R:2\n1 2\n".into(), "expected three coordinates"),
        (Format::Xyz, "1\nProperties=pos:R:3:radius:R:1\n1 2 3 -4\n".into(), "expected a mass and a radius, zero or more"),
        (Format::Xyz, "2\nProperties=pos:R:3:id:I:1\n1 2 3 4\n1 2 4 4\n".into(), "expected another number for each particle"),
        (Format::Xyz, format!("1\n{}\n", "x".repeat(1 << 17)), "expected lines of at most 65536 bytes"),
        (Format::Xyz, format!("1\nProperties={}:R:3\n", "a:R:100:".repeat(3)), "expected Properties=name:type:count"),
        (Format::Dump, "ATOMS\n".into(), "line 1: `ATOMS`: expected ITEM:"),
        (Format::Dump, "ITEM: ATOMS x y z\n1 2 3\n".into(), "expected ITEM: NUMBER OF ATOMS before it"),
        (Format::Dump, format!("{dump} xs ys zs\n1 2 3\n"), "expected a box at right angles"),
        (Format::Xyz, String::new(), "has 0 whole frames"),
        (Format::Xyz, "1\n\nH 1 2 3".into(), "ends in the middle of a frame"),
    ];
    for (format, text, expected) in cases {
        let error = read(format, &text, None).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nbut expected {expected}");
    }
    assert!(read(Format::Xyz, "1\n\nH 1 2 3\n", Some(0)).is_ok());
    assert!(Format::Xyz.read(Cursor::new(b"1\n\nH \xff 2 3\n".as_slice()), None).is_err());
    assert!(read(Format::Dump, &format!("{dump} x y z\n1 2 3\n"), None).is_ok(), "the shape of the box is of no account then");
}

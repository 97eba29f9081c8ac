use serde::{Deserialize, Serialize};

use super::*;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Phase {
    Waiting,
    Running { since: f64 },
}

struct Part {
    numbers: Vec<f64>,
    phase: Option<Phase>,
    scratch: Vec<u8>,
}
resume!(Part { values: [numbers, phase], set_up: [scratch] });

struct Whole {
    count: u64,
    parts: Vec<Part>,
    name: &'static str,
}
resume!(Whole { values: [count], parts: [parts], set_up: [name] });

fn whole(count: u64, numbers: &[f64]) -> Whole {
    let part = |numbers: &[f64], phase| Part { numbers: numbers.to_vec(), phase, scratch: vec![1] };
    let parts = vec![part(numbers, Some(Phase::Running { since: -0.0 })), part(&[], Some(Phase::Waiting)), part(&[1.0], None)];
    Whole { count, parts, name: "set up" }
}

fn bytes(whole: &Whole) -> Vec<u8> {
    let mut out = Writer::new();
    out.part("whole", whole).unwrap();
    out.finish()
}

fn load(bytes: &[u8], into: &mut Whole) -> Result<(), Fault> {
    let mut from = Reader::new(bytes);
    from.part("whole", into)?;
    from.end()
}

/// Every bit of every number, of those that are none as well.
#[test]
fn what_is_saved_is_loaded_to_the_last_bit() {
    let numbers = [0.1, -0.0, f64::MIN_POSITIVE / 3.0, f64::INFINITY, f64::from_bits(0xfff8_dead_beef_0001), 1e300];
    let before = whole(u64::MAX, &numbers);
    let mut after = whole(0, &[]);
    after.parts[2].phase = Some(Phase::Waiting);
    load(&bytes(&before), &mut after).unwrap();
    assert_eq!(after.count, u64::MAX);
    assert!(after.parts[0].numbers.iter().zip(numbers).all(|(a, b)| a.to_bits() == b.to_bits()));
    assert_eq!(after.parts[0].phase, Some(Phase::Running { since: 0.0 }));
    assert_eq!((after.parts[1].phase.clone(), after.parts[2].phase.clone()), (Some(Phase::Waiting), None));
    assert_eq!((after.name, after.parts[0].scratch.clone()), ("set up", vec![1]));
    assert_eq!(bytes(&before), bytes(&after));
}

/// The fault names the field: of another set-up, of another type, cut off.
#[test]
fn what_does_not_fit_is_refused_by_name() {
    let good = bytes(&whole(1, &[2.0]));
    let mut fewer = whole(0, &[]);
    fewer.parts.pop();
    assert_eq!(load(&good, &mut fewer).unwrap_err().to_string(), "whole.parts: 3 items where 2 belong");

    let mut renamed = good.clone();
    let at = good.windows(5).position(|window| window == b"phase").unwrap();
    renamed[at] = b'P';
    assert_eq!(
        load(&renamed, &mut whole(0, &[])).unwrap_err().to_string(),
        "whole.parts.0.phase: the field `Phase` where this one belongs"
    );

    for end in 0..good.len() {
        assert!(load(&good[..end], &mut whole(0, &[])).is_err(), "cut after {end} of {} bytes", good.len());
    }
    assert_eq!(load(&[&good[..], &[0]].concat(), &mut whole(0, &[])).unwrap_err().cause, "1 bytes too many");
}

/// A length of thousands of millions takes no memory before there are as many bytes.
#[test]
fn lengths_are_not_believed() {
    let mut out = Writer::new();
    out.fields(2).unwrap();
    let mut bytes = out.finish();
    bytes.extend([0xa7, b'n', b'u', b'm', b'b', b'e', b'r', b's', 0xdd, 0xff, 0xff, 0xff, 0xff, 0xcb]);
    let mut part = whole(0, &[]).parts.remove(0);
    assert!(part.load(&mut Reader::new(&bytes)).unwrap_err().path.ends_with("numbers"));
    // Nor is a depth.
    assert!(Reader::new(&vec![0x91; 100_000]).value::<u64>("numbers").is_err());
}

use proptest::prelude::*;

use super::*;
use crate::example::REGISTRY;

const FILE: &str = "a scenario.toml";

fn parse(text: &str) -> Result<Scenario, Refusal> {
    Scenario::parse(REGISTRY, text, Path::new(FILE))
}

fn refused(text: &str) -> String {
    match parse(text) {
        Ok(_) => panic!("accepted: {text}"),
        Err(refusal) => refusal.to_string(),
    }
}

#[test]
fn a_full_file_is_read() {
    let scenario = parse(
        "experiment = 'oscillator'\nseed = 18446744073709551615\nduration = 3\n[parameters]\nfrequency = 2\nsamples = 1e2\n\
         start = \"side\"\ndamped = true\nmasses = [1, 2.5]\namplitude = 0x10\n",
    )
    .unwrap();
    let settings = &scenario.settings;
    assert_eq!((settings.seed, scenario.duration), (u64::MAX, Some(3.0)));
    assert_eq!((settings.real("frequency"), settings.whole("samples"), settings.real("amplitude")), (2.0, 100, 16.0));
    assert_eq!((settings.word("start"), settings.flag("damped"), settings.list("masses")), ("side", true, [1.0, 2.5].as_slice()));
}

#[test]
fn every_refusal_names_place_key_value_and_what_was_expected() {
    let parameters = |line: &str| format!("experiment = \"oscillator\"\n[parameters]\n{line}\n");
    for (text, message) in [
        (parameters("frequency = -1.5"), ":3:13: frequency = -1.5: expected a number from"),
        (parameters("frequency = nan"), ":3:13: frequency = nan: expected a number from"),
        (parameters("frequency = inf"), ":3:13: frequency = inf: expected"),
        (parameters("frequency = \"fast\""), ":3:13: frequency = \"fast\": expected a number"),
        (parameters("samples = 0"), ":3:11: samples = 0: expected a whole number from 1 to 1000"),
        (parameters("samples = -3"), ":3:11: samples = -3: expected a whole number"),
        (parameters("samples = 2.5"), ":3:11: samples = 2.5: expected a whole number"),
        (parameters("samples = 99999999999999999999999"), ":3:11: samples = 99999999999999999999999: expected"),
        (parameters("  damped = 1"), ":3:12: damped = 1: expected true or false"),
        (parameters("start = 'top'"), ":3:9: start = 'top': expected one of middle, side"),
        (parameters("masses = [1, 'x']"), ":3:10: masses = [1, 'x']: expected a list"),
        (parameters("masses = [1, 2, 3, 4]"), ":3:10: masses = [1, 2, 3, 4]: expected a list of at most 3"),
        (parameters("masses = { a = 1 }"), ":3:10: masses = { a = 1 }: expected a list"),
        (parameters("samples = 2026-11-22"), ":3:11: samples = 2026-11-22: expected"),
        (parameters("frequncy = 1"), ":3:1: frequncy = (an unknown key): expected one of frequency,"),
        (parameters("frequncy = 1"), "did you mean `frequency`?"),
        (
            "experiment = \"oscilator\"".into(),
            ":1:14: experiment = \"oscilator\": expected one of oscillator; did you mean `oscillator`?",
        ),
        ("experiment = 3".into(), ":1:14: experiment = 3: expected one of oscillator"),
        ("seed = 1".into(), ": experiment = (missing): expected one of oscillator"),
        ("experiment = \"oscillator\"\nseed = -1".into(), ":2:8: seed = -1: expected a whole number"),
        ("experiment = \"oscillator\"\nduration = 0".into(), ":2:12: duration = 0: expected a positive number"),
        ("experiment = \"oscillator\"\nsed = 1".into(), ":2:1: sed = (an unknown key): expected one of experiment, seed"),
        ("experiment = \"oscillator\"\nsamples = 1".into(), ":2:1: samples = (an unknown key): expected it below [parameters]"),
        ("experiment = \"oscillator\"\nparameters = 1".into(), ":2:14: parameters = 1: expected a table"),
        ("experiment = \"oscillator\"\nseed = ".into(), ":2:8: text = `seed =`: expected TOML:"),
        ("experiment = \"oscillator\"\nseed = 1\nseed = 2".into(), ":3:1: text = `seed = 2`: expected TOML: duplicate key"),
    ] {
        let refusal = refused(&text);
        assert!(refusal.starts_with(FILE) && refusal.contains(message), "{text}\ngave: {refusal}\nnot:  {message}");
        assert_eq!(refusal.lines().count(), 1, "{refusal}");
    }
}

/// Deeds belong to files of both kinds, are written as they were read, and are refused where they stand.
#[test]
fn deeds_are_read_written_and_refused_in_their_place() {
    const GAS: &str = "engine = 'event'\nduration = 2.0\n[box]\nlower = [0.0, 0.0]\nupper = [9.0, 9.0]\nfaces = 'walls'\n\
                       [[species]]\ncount = 5\nradius = 0.3\n";
    const DEEDS: &str = "[[deed]]\nat = 0.5\nact = 'reverse'\n[[deed]]\nat = 1.25\n[deed.act.throw]\nbody = 2\n\
                         velocity = [0.1, -3.0, 0.0]\n";
    let throw = Action::Throw { body: 2, velocity: [0.1, -3.0, 0.0] };
    for head in [GAS, "experiment = \"oscillator\"\n[parameters]\nfrequency = 2.0\n"] {
        let scenario = parse(&(head.to_owned() + DEEDS)).unwrap();
        let expected = [Deed { at: 0.5, act: Action::Reverse }, Deed { at: 1.25, act: throw }];
        assert_eq!(scenario.deeds, expected);
        let again = parse(&scenario.to_toml()).unwrap();
        assert_eq!((again.deeds, again.settings.seed), (expected.to_vec(), 1), "{}", scenario.to_toml());
        // A hand at the same time comes after the file.
        let more = parse(head).unwrap().with_deeds(&[(0.5, Action::Reverse)]).with_deeds(&[(0.5, throw), (0.25, throw)]);
        assert_eq!(
            more.deeds.iter().map(|deed| (deed.at, deed.act)).collect::<Vec<_>>(),
            [(0.25, throw), (0.5, Action::Reverse), (0.5, throw)]
        );
    }
    let line = GAS.lines().count() + 2;
    for (deed, message) in [
        ("at = 0.5\nact = 'revers'", format!(":{}:7: deed[0].act = 'revers': expected one of reverse, ", line + 1)),
        ("at = 0.5\nact = 'reverse'\nhow = 1", format!(":{}:1: how = (an unknown key): expected one of at, act", line + 2)),
        ("at = 'soon'\nact = 'reverse'", format!(":{line}:6: deed[0].at = 'soon': expected a number")),
        ("act = 'reverse'", format!(":{}:1: deed[0].at = (missing): expected a value: this key is needed", line - 1)),
        ("at = 0.5\nact = { throw = { body = -1, velocity = [0.0, 0.0, 0.0] } }", format!(":{}:", line + 1)),
    ] {
        let refusal = refused(&format!("{GAS}[[deed]]\n{deed}\n"));
        assert!(refusal.contains(&message), "{deed}\ngave: {refusal}\nnot:  {message}");
    }
    let disorder = parse(&format!("{GAS}[[deed]]\nat = 1.0\nact = 'reverse'\n[[deed]]\nat = 0.5\nact = 'reverse'\n")).unwrap();
    let refusal = disorder.start().err().unwrap().to_string();
    assert!(refusal.contains(&format!(":{}:6: deed[1].at = 0.5: expected a time, 1 or later", line + 3)), "{refusal}");
}

#[test]
fn an_impossible_combination_is_traced_back_to_its_line() {
    let scenario = parse("experiment = \"oscillator\"\n[parameters]\nfrequency = 1\n\namplitude = 1e4").unwrap();
    let refusal = scenario.start().err().unwrap().to_string();
    assert_eq!(refusal, "a scenario.toml:5:13: amplitude = 10000: expected a speed below light's");
    let mut scenario = scenario;
    scenario.set("amplitude", "1e5").unwrap();
    let refusal = scenario.start().err().unwrap().to_string();
    assert_eq!(refusal, "on the command line: amplitude = 100000: expected a speed below light's");
}

#[test]
fn what_is_not_a_file_of_text_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let read = |path: &Path| Scenario::read(REGISTRY, path).err().unwrap().to_string();
    assert!(read(folder.path()).contains("file = a folder: expected a scenario file"));
    assert!(read(&folder.path().join("none.toml")).contains("No such file"));
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [b'a', 0xff, 0xfe]).unwrap();
    assert!(read(&binary).contains("byte 1 is not UTF-8"));
    let endless = folder.path().join("long.toml");
    std::fs::File::create(&endless).unwrap().set_len(source::LONGEST + 1).unwrap();
    assert!(read(&endless).contains("at most 16 MiB"));
}

/// The values of two scenarios, and which of them were given, to the last bit.
fn same(a: &Scenario, b: &Scenario) -> bool {
    let values = |scenario: &Scenario| {
        format!("{:?}", scenario.parameters().map(|(_, value, given)| (value.clone(), given)).collect::<Vec<_>>())
    };
    values(a) == values(b) && a.settings.seed == b.settings.seed && a.duration.map(f64::to_bits) == b.duration.map(f64::to_bits)
}

const VALID: &str = "experiment = \"oscillator\"\nseed = 7\nduration = 1.5\n[parameters]\nfrequency = 0.25\nmasses = [1.0, 2.0]\nstart = \"side\"\n";

proptest! {
    #[test]
    fn a_written_scenario_reads_back_to_the_same_bits(
        seed: u64, frequency in 1e-300..10.0f64, amplitude: f64, masses in prop::collection::vec(0.0..9.0f64, 0..4),
        duration: f64, samples in 1..1000u64, damped: bool
    ) {
        let mut scenario = Scenario::new(REGISTRY[0]);
        scenario.settings.seed = seed;
        scenario.settings.set("frequency", Value::Real(frequency)).unwrap();
        scenario.settings.set("samples", Value::Whole(samples)).unwrap();
        scenario.settings.set("masses", Value::List(masses)).unwrap();
        scenario.settings.set("damped", Value::Flag(damped)).unwrap();
        // Whatever is refused stays at its default, which is part of the test.
        let _ = scenario.settings.set("amplitude", Value::Real(amplitude));
        let _ = scenario.set_duration(duration);
        let again = parse(&scenario.to_toml()).unwrap();
        prop_assert!(same(&scenario, &again), "{}", scenario.to_toml());
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = parse(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn no_text_of_toml_signs_makes_the_reader_panic(text in "[\\[\\]{}=\"'.,#\\\\ \n0-9a-fxé_+-]{0,120}") {
        let _ = parse(&text);
        let _ = parse(&format!("experiment = \"oscillator\"\n[parameters]\n{text}"));
        let _ = parse(&format!("experiment = \"oscillator\"\n[parameters]\nfrequency = {text}"));
    }

    #[test]
    fn a_damaged_file_is_read_or_refused_on_one_line(place in 0..VALID.len(), insert in "\\PC{0,3}", cut in 0..6usize) {
        let end = (place + cut).min(VALID.len());
        let text = format!("{}{insert}{}", &VALID[..place], &VALID[end..]);
        if let Err(refusal) = parse(&text) {
            prop_assert_eq!(refusal.to_string().lines().count(), 1);
        }
    }
}

#[test]
fn deep_nesting_is_refused_and_not_followed() {
    let deep = format!("experiment = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(refused(&deep).starts_with(FILE));
}

const FREE: &str = "seed = 9\nengine = \"event\"\nduration = 2.0\n\n[box]\nlower = [0.0, 0.0]\nupper = [10.0, 10.0]\nfaces = \"walls\"\n\n\
                    [[species]]\ncount = 5\nradius = 0.3\n";

#[test]
fn a_system_of_its_own_is_read_written_and_located() {
    let scenario = parse(FREE).unwrap();
    assert_eq!((scenario.name(), scenario.settings.seed), ("free", 9));
    let again = parse(&scenario.to_toml()).unwrap();
    assert_eq!(scenario.to_toml(), again.to_toml());
    let mut simulation = again.start().unwrap();
    simulation.advance(0.5).unwrap();
    assert_eq!(simulation.time(), 0.5);
    for (from, to, message) in [
        ("radius = 0.3", "radius = -0.3", ":12:10: species[0].radius = -0.3: expected"),
        ("radius = 0.3", "radius = \"big\"", ":12:10: species[0].radius = \"big\": expected a number"),
        ("count = 5", "cuont = 5", ":11:1: cuont = (an unknown key): expected one of name, count,"),
        ("radius = 0.3", "raduis = 0.3", ":12:1: raduis = (an unknown key): expected one of"),
        ("radius = 0.3", "raduis = 0.3", "did you mean `radius`?"),
        ("\"walls\"", "\"wals\"", ":8:9: box.faces = \"wals\": expected one of periodic, walls, open; did you mean `walls`?"),
        ("\"walls\"", "[\"walls\", \"wals\"]", "did you mean `walls`?"),
        ("\"walls\"", "3", ":8:9: box.faces = 3: expected one of periodic, walls, open"),
        ("faces = ", "facse = ", "did you mean `faces`?"),
        ("\"event\"", "\"evnt\"", ":2:10: engine = \"evnt\": expected one of event, time; did you mean `event`?"),
        ("seed = 9", "seed = -9", ":1:8: seed = -9: expected a whole number"),
        ("\"event\"", "\"magic\"", ":2:10: engine = \"magic\": expected one of event, time"),
    ] {
        let refusal = parse(&FREE.replace(from, to)).and_then(|scenario| scenario.start().map(|_| ())).unwrap_err().to_string();
        assert!(refusal.contains(message), "{refusal}\nnot {message}");
    }
}

//! The window's state under keys and panels.

use super::*;
use corpuscle_experiments::REGISTRY;

fn model() -> Model {
    Model::new(REGISTRY, Scenario::new(REGISTRY[0]), Preferences::default())
}

fn orders(model: &mut Model) -> String {
    let word = |order: &Order| match order {
        Order::Start(scenario) => format!("start {} {}", scenario.name(), scenario.settings.seed),
        Order::Play(on) => format!("play {on}"),
        Order::Speed(factor) => format!("speed {factor}"),
        Order::Step => "step".into(),
        Order::Paint(paint) => format!("{paint:?}"),
        Order::Arrows(on) => format!("arrows {on}"),
        Order::Beside(rival) => format!("beside {:?}", rival.as_ref().map(|(name, _)| name)),
        Order::NextEvent => "next".into(),
        Order::Act(action) => format!("{action:?}"),
        Order::Probe(corners) => format!("probe {corners:?}"),
        Order::GoTo(time) => format!("to {time}"),
    };
    model.take_orders().iter().map(word).collect::<Vec<_>>().join(", ")
}

fn at(time: f64) -> Snapshot {
    Snapshot { time, end: 60.0, ..Snapshot::default() }
}

#[test]
fn moments_are_gone_through_in_order() {
    let mut model = model();
    for time in [20.0, 5.0, 20.0] {
        model.obey(Command::Remember, &at(time));
    }
    assert_eq!(model.moments, [5.0, 20.0]);
    for (command, from, to) in [
        (Command::PreviousMoment, 25.0, "to 20"),
        (Command::PreviousMoment, 20.0, "to 5"),
        (Command::PreviousMoment, 5.0, "to 0"),
        (Command::NextMoment, 0.0, "to 5"),
        (Command::NextMoment, 20.0, ""),
    ] {
        model.obey(command, &at(from));
        assert_eq!(orders(&mut model), to, "{command:?} from {from}");
    }
}

#[test]
fn a_parameter_starts_the_run_again_and_goes_back_to_its_default() {
    let mut model = model();
    let parameter = REGISTRY[0].parameters.iter().find(|parameter| parameter.name == "temperature").unwrap();
    model.set_parameter(parameter, Some(Value::Real(2.0)));
    assert_eq!(orders(&mut model), "start brownian 1");
    assert_eq!(model.scenario.settings.real("temperature"), 2.0);
    assert!(model.scenario.to_toml().contains("\ntemperature = 2"));
    model.set_parameter(parameter, Some(Value::Real(-2.0)));
    assert!(model.notice.take().unwrap().fault);
    assert_eq!(model.scenario.settings.real("temperature"), 2.0);
    model.set_parameter(parameter, None);
    assert!(!model.scenario.settings.is_given("temperature"));
    assert_eq!(model.scenario.settings.real("temperature"), 1.0);
}

#[test]
fn another_experiment_begins_afresh() {
    let mut model = model();
    model.obey(Command::Remember, &at(3.0));
    model.followed = Some(3);
    model.obey(Command::NextExperiment, &at(3.0));
    assert_eq!(model.scenario.name(), REGISTRY[1].name);
    assert!(model.moments.is_empty() && model.followed.is_none());
    assert_eq!(orders(&mut model), format!("start {} 1, play true", REGISTRY[1].name));
    model.obey(Command::PreviousExperiment, &at(0.0));
    model.obey(Command::PreviousExperiment, &at(0.0));
    assert_eq!(model.scenario.name(), REGISTRY[REGISTRY.len() - 1].name);
    assert_eq!(model.preferences.experiment.as_deref(), Some(REGISTRY[REGISTRY.len() - 1].name));
}

#[test]
fn the_same_key_closes_what_it_opened() {
    let mut model = model();
    for (command, overlay) in
        [(Command::Help, Overlay::Help), (Command::Gallery, Overlay::Gallery), (Command::Record, Overlay::Record)]
    {
        model.obey(command, &at(0.0));
        assert_eq!(model.overlay, overlay);
        model.obey(command, &at(0.0));
        assert_eq!(model.overlay, Overlay::None);
    }
    model.obey(Command::Save, &at(0.0));
    assert_eq!(model.typed.path, "brownian.toml");
    model.obey(Command::Close, &at(0.0));
    assert_eq!(model.overlay, Overlay::None);
}

#[test]
fn a_file_that_cannot_be_read_is_explained() {
    let mut model = model();
    model.open("no/such/file.toml".as_ref());
    let notice = model.notice.clone().unwrap();
    assert!(notice.fault && notice.words.contains("no/such/file.toml"), "{notice:?}");
    assert_eq!(orders(&mut model), "");
}

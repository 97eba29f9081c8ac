//! The panels as a person meets them: by the names that a screen reader says, with clicks and keys, without OpenGL.

#![allow(clippy::unwrap_used, clippy::panic)] // in the helpers too: a test that cannot be set up has failed

use corpuscle_experiments::{REGISTRY, find};
use corpuscle_io::Scenario;
use corpuscle_lab::command::Command;
use corpuscle_lab::language::{Language, Text};
use corpuscle_lab::model::{Job, Model, Overlay, Tab};
use corpuscle_lab::previews::Previews;
use corpuscle_lab::theme::Theme;
use corpuscle_lab::{Order, Preferences, Runner, theme, ui};
use corpuscle_scene::Scene;
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

/// A window on an experiment, with its simulation's thread.
struct Window {
    model: Model,
    runner: Runner,
}

fn window(name: &str, set: &[(&str, &str)], language: Language, size: [f32; 2]) -> Harness<'static, Window> {
    let mut scenario = Scenario::new(find(name).unwrap());
    for (key, value) in set {
        scenario.set(key, value).unwrap();
    }
    let preferences = Preferences { language, theme: Theme::Dark, hints_seen: 9, ..Preferences::default() };
    let runner = Runner::start(scenario.clone(), || {}).unwrap();
    harness_of(Window { model: Model::new(REGISTRY, scenario, preferences), runner }, size)
}

/// The panels of a window, without a stage.
fn harness_of(state: Window, size: [f32; 2]) -> Harness<'static, Window> {
    Harness::builder()
        .with_size(size)
        .with_context_setup(|context| {
            context.set_fonts(theme::fonts());
            Theme::Dark.apply(context);
        })
        .build_ui_state(
            |ui, window: &mut Window| {
                window.runner.refresh();
                ui::show(ui, &mut window.model, window.runner.snapshot(), &Previews::none(), &mut ui::Blank);
                for order in window.model.take_orders() {
                    window.runner.order(order);
                }
            },
            state,
        )
}

fn small(name: &str) -> Harness<'static, Window> {
    let set: &[(&str, &str)] = if name == "brownian" { &[("particles", "30"), ("replicas", "2")] } else { &[] };
    window(name, set, Language::English, [1280.0, 800.0])
}

/// Steps until something is so; the simulation's thread needs its time.
fn until(harness: &mut Harness<'static, Window>, what: &str, so: impl Fn(&Window) -> bool) {
    for _ in 0..3000 {
        harness.step();
        if so(harness.state()) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    panic!("waited in vain for: {what}");
}

fn press(harness: &mut Harness<'static, Window>, key: Key) {
    harness.key_press(key);
    harness.run_steps(2);
}

#[test]
fn the_space_bar_and_the_button_let_time_pass_and_stop_it() {
    let mut harness = small("brownian");
    harness.run_steps(2);
    press(&mut harness, Key::Space);
    until(&mut harness, "time to pass", |window| window.runner.snapshot().time > 0.0);
    harness.get_by_label("Pause").click();
    until(&mut harness, "the pause", |window| !window.runner.snapshot().playing);
    let stopped = harness.state().runner.snapshot().time;
    press(&mut harness, Key::Period);
    until(&mut harness, "a step", |window| window.runner.snapshot().time > stopped);
    press(&mut harness, Key::R);
    until(&mut harness, "the start", |window| window.runner.snapshot().time == 0.0);
}

#[test]
fn every_experiment_can_be_reached_by_keys_alone() {
    let mut harness = small("brownian");
    harness.run_steps(2);
    let mut seen = vec![];
    for _ in REGISTRY {
        seen.push(harness.state().model.scenario.name().to_owned());
        let run = harness.state().runner.snapshot().run;
        press(&mut harness, Key::CloseBracket);
        until(&mut harness, "the next experiment", |window| window.runner.snapshot().run > run);
        until(&mut harness, "its time to pass", |window| window.runner.snapshot().time > window.runner.snapshot().start);
        press(&mut harness, Key::Space);
    }
    assert_eq!(seen, REGISTRY.iter().map(|experiment| experiment.name).collect::<Vec<_>>());
    assert_eq!(harness.state().model.scenario.name(), seen[0], "round");
}

#[test]
fn tabs_dialogs_and_the_list_of_keys_open_and_close() {
    let mut harness = small("wave");
    harness.run_steps(2);
    for (key, tab) in [(Key::Num2, Tab::Checks), (Key::Num3, Tab::Honesty), (Key::Num4, Tab::Notebook), (Key::Num1, Tab::Charts)] {
        press(&mut harness, key);
        assert_eq!(harness.state().model.tab, tab);
    }
    press(&mut harness, Key::Questionmark);
    harness.get_by_label("This list");
    press(&mut harness, Key::Escape);
    assert_eq!(harness.state().model.overlay, Overlay::None);
    press(&mut harness, Key::G);
    for experiment in REGISTRY {
        assert!(harness.query_all_by_label(experiment.title).next().is_some(), "{} has a card", experiment.title);
    }
    harness.get_by_label("Three stars and dust").click();
    harness.run_steps(3);
    assert_eq!(harness.state().model.scenario.name(), "three-body");
}

#[test]
fn a_row_is_recorded_and_the_moment_is_marked() {
    let mut harness = small("brownian");
    harness.run_steps(2);
    harness.state().runner.order(Order::GoTo(30.0));
    until(&mut harness, "the time", |window| window.runner.snapshot().time == 30.0 && window.runner.snapshot().travel.is_none());
    press(&mut harness, Key::M);
    press(&mut harness, Key::N);
    press(&mut harness, Key::N);
    let model = &harness.state().model;
    assert_eq!(model.moments, [30.0]);
    assert_eq!((model.tab, model.notebook.rows().len()), (Tab::Notebook, 2));
    assert_eq!(model.notebook.rows()[0][0].value, 30.0);
}

#[test]
fn a_refused_parameter_says_what_was_expected_and_the_run_goes_on() {
    let mut harness = small("brownian");
    harness.run_steps(2);
    let parameter = find("brownian").unwrap().parameters.iter().find(|parameter| parameter.name == "radius").unwrap();
    harness.state_mut().model.set_parameter(parameter, Some(corpuscle_experiments::Value::Real(9000.0)));
    until(&mut harness, "the refusal", |window| window.runner.snapshot().fault.is_some());
    assert!(harness.query_all_by_label_contains("at most").next().is_some());
    assert!(harness.state().runner.is_alive());
}

/// Everything that can be pressed has a name for screen readers and lies wholly inside the window, in both languages and at two
/// sizes; and every character has a glyph: the harness panics over a missing one, and over a missing name.
#[test]
fn whatever_can_be_pressed_has_a_name_and_a_place() {
    use egui::accesskit::Role;
    use egui_kittest::kittest::{By, NodeT};
    let pressable = |role| matches!(role, Role::Button | Role::Slider | Role::SpinButton | Role::ComboBox | Role::TextInput);
    for (language, size) in
        [(Language::English, [1280.0, 800.0]), (Language::Chinese, [1280.0, 800.0]), (Language::Chinese, [1920.0, 1080.0])]
    {
        for experiment in REGISTRY.iter().take(5) {
            let set: &[(&str, &str)] =
                if experiment.name == "wave" || experiment.name == "three-body" { &[] } else { &[("replicas", "3")] };
            let mut harness = window(experiment.name, set, language, size);
            for (tab, ..) in Tab::ALL {
                harness.state_mut().model.tab = tab;
                harness.run_steps(3);
                let found: Vec<_> = harness.query_all(By::new().predicate(move |node| pressable(node.role()))).collect();
                assert!(found.len() > 15, "{} {tab:?}: only {} things to press", experiment.name, found.len());
                for node in found {
                    let (rect, node) = (node.rect(), node.accesskit_node());
                    let named = node.label().is_some_and(|label| !label.is_empty()) || node.labelled_by().next().is_some();
                    assert!(named, "{language:?} {} {tab:?}: {node:?} has no name", experiment.name);
                    let across = rect.left() >= 0.0 && rect.right() <= size[0];
                    assert!(across, "{language:?} {} {tab:?}: {:?} reaches outside: {rect:?}", experiment.name, node.label());
                }
            }
        }
    }
}

#[test]
fn the_font_has_every_character_of_the_table_and_the_phrases() {
    let mut harness = small("wave");
    harness.run_steps(1);
    let context = harness.ctx.clone();
    let id = egui::FontId::proportional(13.0);
    let phrases = corpuscle_lab::language::phrases::entries().map(|(_, chinese)| chinese);
    let words = Text::ALL.iter().flat_map(|&text| Language::ALL.map(|language| language.text(text))).chain(phrases);
    let missing: std::collections::BTreeSet<char> =
        words.flat_map(str::chars).filter(|&c| !context.fonts_mut(|fonts| fonts.has_glyph(&id, c))).collect();
    assert!(missing.is_empty(), "run scripts/subset-fonts.sh: the fonts lack {missing:?}");
}

/// A drag with the tool that carries puts the body where the pointer lets go; time goes on afterwards, and the deed is on record.
#[test]
fn a_body_is_carried_and_thrown_with_the_pointer() {
    use corpuscle_experiments::Action;
    use corpuscle_lab::tools::Tool;
    let mut harness = window(
        "ideal-gas",
        &[("particles", "20"), ("replicas", "3"), ("dense_packings", "[]")],
        Language::English,
        [1280.0, 800.0],
    );
    harness.run_steps(3);
    for tool in [Tool::Carry, Tool::Throw] {
        harness.get_by_label(Language::English.text(tool.text())).click();
        harness.run_steps(2);
        assert_eq!(harness.state().model.tool, tool);
        let stage = harness.get_by_label("Stage").rect();
        // The picture is square and in the middle of the stage: from the box to the window.
        let scene = harness.state().runner.snapshot().scene.clone();
        let [lower, upper] = scene.bounds.unwrap();
        let side = stage.height().min(stage.width()) / 1.04;
        let pixel = |place: [f64; 3]| {
            let part = |k: usize| ((place[k] - lower[k]) / (upper[k] - lower[k]) - 0.5) as f32;
            stage.center() + egui::vec2(part(0) * side, -part(1) * side)
        };
        let from = pixel(scene.bodies[5].position);
        let to = from + egui::vec2(if from.x > stage.center().x { -60.0 } else { 60.0 }, 0.0);
        harness.drag_at(from);
        harness.run_steps(2);
        harness.hover_at(from + 0.5 * (to - from));
        harness.run_steps(2);
        harness.hover_at(to);
        harness.run_steps(2);
        harness.drop_at(to);
        harness.run_steps(2);
        let wanted = tool;
        until(&mut harness, "the deed", |window| {
            window.runner.snapshot().deeds.iter().any(|(_, action)| match action {
                Action::Place { body, .. } => wanted == Tool::Carry && *body == 5,
                Action::Throw { body, velocity } => wanted == Tool::Throw && *body == 5 && velocity[0].abs() > 0.0,
                _ => false,
            })
        });
        assert!(harness.state().runner.snapshot().fault.is_none());
    }
    harness.state_mut().model.tab = Tab::Notebook;
    harness.run_steps(2);
    assert!(harness.query_all_by_label_contains("carried body 5").next().is_some());
    what_is_saved_gives_the_same(&mut harness);
}

/// The file that the window saves runs to the same picture, with all that hands did.
fn what_is_saved_gives_the_same(harness: &mut Harness<'static, Window>) {
    let state = harness.state_mut();
    state.model.obey(Command::Save, &state.runner.snapshot().clone());
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, Language::English.text(Text::Save)).click();
    harness.run_steps(3);
    let jobs = harness.state_mut().model.take_jobs();
    let [Job::Write(path, bytes)] = &jobs[..] else { panic!("{jobs:?}") };
    let scenario = Scenario::parse(REGISTRY, std::str::from_utf8(bytes).unwrap(), path).unwrap();
    let snapshot = harness.state().runner.snapshot();
    assert!(scenario.deeds.len() == snapshot.deeds.len() && !scenario.deeds.is_empty());
    let mut simulation = scenario.start().unwrap();
    simulation.advance(snapshot.time).unwrap();
    let mut scene = Scene::default();
    simulation.draw(&mut scene);
    let places = |scene: &Scene| scene.bodies.iter().map(|body| (body.position, body.velocity)).collect::<Vec<_>>();
    assert_eq!(places(&scene), places(&snapshot.scene));
}

#[test]
fn a_check_leads_to_its_chart_and_back() {
    let mut harness = small("brownian");
    harness.run_steps(2);
    let end = harness.state().runner.snapshot().end;
    harness.state().runner.order(Order::GoTo(end));
    until(&mut harness, "checks", |window| {
        window.runner.snapshot().measured.checks.len() > 4 && window.runner.snapshot().travel.is_none()
    });
    press(&mut harness, Key::Num2);
    harness.get_by_label("Show its chart: diffusion coefficient D, Einstein").click();
    harness.run_steps(2);
    assert_eq!((harness.state().model.tab, harness.state().model.large_chart.as_deref()), (Tab::Charts, Some("diffusion")));
    harness.get_by_label_contains("Back to the checks").click();
    harness.run_steps(2);
    assert_eq!(harness.state().model.tab, Tab::Checks);
}

#[test]
fn another_integrator_runs_beside() {
    let mut harness = small("three-body");
    harness.run_steps(2);
    harness.state_mut().model.set_beside(Some("yoshida-4"));
    until(&mut harness, "the other half", |window| {
        window.runner.snapshot().beside.is_some() && window.runner.snapshot().travel.is_none()
    });
    assert_eq!(harness.state().runner.snapshot().measured.charts[0].name, "agreement");
    press(&mut harness, Key::R);
    until(&mut harness, "both from the start", |window| {
        window.runner.snapshot().beside.is_some() && window.runner.snapshot().run > 2
    });
}

/// What is asked of the window while the engine has 10^5 particles and more work than it can do is done within two frames; the
/// frames themselves are short, since nothing in them waits for the engine.
#[test]
fn the_window_answers_while_the_engine_is_saturated() {
    let gas = "engine = 'event'\nduration = 1000.0\n[box]\nlower = [0.0, 0.0]\nupper = [560.0, 560.0]\nfaces = 'periodic'\n\
               [[species]]\ncount = 100000\nradius = 0.5\n";
    let scenario = Scenario::parse(REGISTRY, gas, std::path::Path::new("gas.toml")).unwrap();
    let preferences = Preferences { hints_seen: 9, ..Preferences::default() };
    let runner = Runner::start(scenario.clone(), || {}).unwrap();
    runner.order(Order::Play(true));
    runner.order(Order::Speed(100.0));
    let state = Window { model: Model::new(REGISTRY, scenario, preferences), runner };
    let mut harness = harness_of(state, [1280.0, 800.0]);
    until(&mut harness, "the engine to fall behind", |window| window.runner.snapshot().pace < 0.5);
    let mut slowest = std::time::Duration::ZERO;
    for (key, tab) in [(Key::Num2, Tab::Checks), (Key::Num3, Tab::Honesty), (Key::Num1, Tab::Charts)].repeat(5) {
        harness.key_press(key);
        let began = std::time::Instant::now();
        harness.run_steps(2);
        slowest = slowest.max(began.elapsed());
        assert_eq!(harness.state().model.tab, tab, "not within two frames");
    }
    // Two frames of a screen take 33 ms; this machine may be shared, and the engine has a thread of its own on it.
    assert!(slowest < std::time::Duration::from_millis(500), "two frames took {slowest:?}");
}

/// The sliders show what the run takes, and those that it does not read are grey and say why.
#[test]
fn a_slider_shows_what_a_preset_sets() {
    for language in Language::ALL {
        let mut harness = window("wave", &[("preset", "solitons")], language, [1280.0, 800.0]);
        harness.run_steps(2);
        let name = language.parameter("wave", "masses");
        let shown = harness.get_by_role_and_label(Role::Slider, &name).accesskit_node().numeric_value();
        assert_eq!(shown, Some(300.0));
        let (preset, choice) = (language.parameter("wave", "preset"), language.choice("solitons"));
        let words = language.fill(Text::NotUsed, &[&preset, &choice]);
        let grey = |key: &str| format!("{}: {words}", language.parameter("wave", key));
        assert!(harness.query_by_label(&grey("density_ratio")).is_some(), "{}", grey("density_ratio"));
        assert!(harness.query_by_label(&grey("masses")).is_none());
    }
}

/// What a file does stands on the timeline and in the notebook from the beginning, beside what hands do.
#[test]
fn deeds_of_a_file_are_listed() {
    for language in Language::ALL {
        let text = "experiment = 'ideal-gas'\n[parameters]\nparticles = 20\nreplicas = 3\ndense_packings = []\n\
                    [[deed]]\nat = 3.0\nact = 'reverse'\n[[deed]]\nat = 7.5\nact = { throw = { body = 4, velocity = [1.0, 0.0, 0.0] } }\n";
        let scenario = Scenario::parse(REGISTRY, text, std::path::Path::new("deeds.toml")).unwrap();
        let preferences = Preferences { language, hints_seen: 9, ..Preferences::default() };
        let runner = Runner::start(scenario.clone(), || {}).unwrap();
        let mut harness = harness_of(Window { model: Model::new(REGISTRY, scenario, preferences), runner }, [1280.0, 800.0]);
        harness.state_mut().model.tab = Tab::Notebook;
        harness.run_steps(3);
        assert!(harness.query_by_label(language.text(Text::DeedsOfFile)).is_some());
        assert!(harness.query_by_label(&format!("t = 3: {}", language.text(Text::DidReverse))).is_some());
        let thrown = language.fill(Text::DidThrow, &["4"]);
        assert!(harness.query_by_label(&format!("t = 7.5: {thrown}")).is_some());
        // The pointer reads a mark on the line of time.
        let line = harness.get_by_label_contains(language.text(Text::Timeline)).rect();
        let end = harness.state().runner.snapshot().end;
        let x = line.left() + 7.0 + (line.width() - 69.0) * (7.5 / end) as f32;
        harness.hover_at(egui::pos2(x, line.center().y - 6.0));
        harness.run_steps(40);
        let tip = format!("{}: t = 7.5: {thrown}", language.text(Text::DeedsOfFile));
        assert!(harness.query_by_label(&tip).is_some(), "{tip}");
    }
}

/// A tool that an experiment refuses is grey, cannot be chosen, and says what it would need.
#[test]
fn refused_tools_are_grey_and_say_why() {
    use corpuscle_lab::tools::Tool;
    let mut harness = window("galton", &[("replicas", "3"), ("balls", "20")], Language::English, [1280.0, 800.0]);
    harness.run_steps(2);
    let name = Language::English.text(Tool::Throw.text());
    let button = harness.get_by_label(name);
    assert!(button.accesskit_node().is_disabled());
    let at = button.rect().center();
    harness.hover_at(at);
    harness.run_steps(40);
    assert!(harness.query_by_label_contains("each of these is one draw").is_some());
    press(&mut harness, Key::T);
    assert_eq!(harness.state().model.tool, Tool::Ruler);
}

/// Drags across the stage between two places of the picture, or clicks where both are the same.
fn touch(harness: &mut Harness<'static, Window>, from: [f64; 3], to: [f64; 3]) {
    use corpuscle_render::{Projection, Rectangle};
    let stage = harness.get_by_label("Stage").rect();
    let size = [f64::from(stage.width()), f64::from(stage.height())];
    let rectangle = Rectangle { left: 0.0, top: 0.0, width: size[0], height: size[1] };
    let projection = Projection::new(harness.state().runner.snapshot().scene.camera, size, rectangle);
    let spot = |place: [f64; 3]| {
        let [x, y] = projection.pixel(place).unwrap();
        stage.min + egui::vec2(x as f32, y as f32)
    };
    let (from, to) = (spot(from), spot(to));
    harness.drag_at(from);
    harness.run_steps(2);
    if from != to {
        harness.hover_at(from + 0.5 * (to - from));
        harness.run_steps(2);
        harness.hover_at(to);
        harness.run_steps(2);
    }
    harness.drop_at(to);
    harness.run_steps(2);
}

fn choose(harness: &mut Harness<'static, Window>, tool: corpuscle_lab::tools::Tool) {
    harness.get_by_label(Language::English.text(tool.text())).click();
    harness.run_steps(2);
    assert_eq!(harness.state().model.tool, tool);
}

/// Piston, heat bath, partition with a hole, and their way back: each with the pointer, on the stage.
#[test]
fn the_tools_of_the_box_reach_the_system() {
    use corpuscle_experiments::Action;
    use corpuscle_lab::tools::Tool;
    let quick = [("particles", "20"), ("replicas", "3")];
    let mut harness = window("ideal-gas", &[quick[0], quick[1], ("process", "piston")], Language::English, [1280.0, 800.0]);
    harness.run_steps(3);
    choose(&mut harness, Tool::Piston);
    let [lower, upper] = harness.state().runner.snapshot().scene.bounds.unwrap();
    let at = |x: f64, y: f64| [lower[0] + x * (upper[0] - lower[0]), lower[1] + y * (upper[1] - lower[1]), 0.0];
    touch(&mut harness, at(0.5, 0.5), at(0.6, 0.5));
    until(
        &mut harness,
        "the push",
        |window| matches!(window.runner.snapshot().deeds[..], [(_, Action::Push { velocity })] if velocity[0] > 0.0),
    );
    assert!(harness.state().runner.snapshot().fault.is_none());

    let dense = ("dense_packings", "[]");
    let mut harness = window("ideal-gas", &[quick[0], quick[1], dense], Language::English, [1280.0, 800.0]);
    harness.run_steps(3);
    let [lower, upper] = harness.state().runner.snapshot().scene.bounds.unwrap();
    let at = |x: f64, y: f64| [lower[0] + x * (upper[0] - lower[0]), lower[1] + y * (upper[1] - lower[1]), 0.0];
    choose(&mut harness, Tool::Heat);
    touch(&mut harness, at(0.98, 0.5), at(0.98, 0.5));
    until(&mut harness, "the warm wall", |window| {
        let warm = Action::Heat { axis: 0, upper: true, temperature: Some(4.0) };
        window.runner.snapshot().deeds.last().map(|deed| deed.1) == Some(warm)
    });
    assert!(harness.state().runner.snapshot().scene.labels.iter().any(|label| label.text == "kT = 4"));
    choose(&mut harness, Tool::Partition);
    touch(&mut harness, at(0.4, 0.5), at(0.4, 0.5));
    until(&mut harness, "the plate", |window| {
        let scene = &window.runner.snapshot().scene;
        let x = lower[0] + 0.4 * (upper[0] - lower[0]);
        // Two strips, with the hole between them.
        scene.lines.iter().filter(|line| (line.from[0] - x).abs() < 0.01 * x && line.from[0] == line.to[0]).count() == 2
    });
    press(&mut harness, Key::O);
    until(&mut harness, "no plate", |window| {
        window.runner.snapshot().deeds.last().map(|deed| deed.1) == Some(Action::OpenPartitions)
    });
    assert!(harness.state().runner.snapshot().fault.is_none());

    choose(&mut harness, Tool::Probe);
    touch(&mut harness, at(0.1, 0.1), at(0.9, 0.9));
    press(&mut harness, Key::Space);
    until(&mut harness, "collisions in the probe", |window| {
        window.runner.snapshot().probed.is_some_and(|probed| probed.contacts > 5 && probed.collisional.is_some())
    });
}

/// A mass of the chain is plucked by dragging it across, and is drawn where it was let go.
#[test]
fn a_chain_is_plucked_with_the_pointer() {
    use corpuscle_experiments::Action;
    use corpuscle_lab::tools::Tool;
    let mut harness = window("wave", &[("preset", "fixed-end")], Language::English, [1280.0, 800.0]);
    harness.run_steps(3);
    choose(&mut harness, Tool::Carry);
    let from = harness.state().runner.snapshot().scene.bodies[70].position;
    let to = [from[0], from[1] + 8.0, 0.0];
    touch(&mut harness, from, to);
    until(&mut harness, "the pluck", |window| matches!(window.runner.snapshot().deeds[..], [(_, Action::Place { body: 70, .. })]));
    let snapshot = harness.state().runner.snapshot();
    assert!(snapshot.fault.is_none() && (snapshot.scene.bodies[70].position[1] - to[1]).abs() < 0.5);
}

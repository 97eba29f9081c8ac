//! The board on show: pegs, balls in flight, and the bins below with those that are down.

use corpuscle_core::Engine;
use corpuscle_scene::{Body, Camera, Colour, Colouring, Line, Scene, Shade};

use super::board::{Board, Set};
use super::walk::binomial;

/// Deepest bins.
const DEEPEST: f64 = 6.0;
/// Speed with which a ball leaves the pegs, about.
const LEAVING: f64 = 1.2;

/// The bins: how deep they are, and how balls lie in them.
struct Bins {
    depth: f64,
    /// Balls side by side, and the height of a layer of them.
    beside: usize,
    layer: f64,
}

impl Bins {
    /// Room for one and a half times as many balls as the fullest bin of a binomial gets.
    fn new(set: &Set) -> Self {
        let beside = ((1.0 / (2.0 * set.ball)) as usize).max(1);
        let fullest = 1.5 * set.balls as f64 * binomial(set.rows, (set.rows % 2) as i32) / beside as f64;
        // What has no room is drawn closer together.
        let layer = (2.0 * set.ball).min(DEEPEST / fullest);
        Self { depth: (layer * fullest).max(1.0), beside, layer }
    }

    /// Place of the `index`-th ball of a bin, from its middle and from its floor.
    fn place(&self, index: usize, radius: f64) -> [f64; 2] {
        let (column, layer) = (index % self.beside, index / self.beside);
        let across = (column as f64 + 0.5) / self.beside as f64 - 0.5;
        [across, radius - self.depth + self.layer * layer as f64]
    }
}

pub(super) fn draw(set: &Set, board: &Board, scene: &mut Scene) {
    scene.clear();
    scene.time = board.engine.time();
    scene.field = [0.0, -1.0, 0.0];
    scene.shaded = Shade::Own;
    let bins = Bins::new(set);
    // Bodies as of now stay where they are: only balls in flight feel the field.
    let still = |x: f64, y: f64, radius: f64, shade: f64| Body {
        position: [x, y, 0.0],
        velocity: [0.0; 3],
        time: board.engine.time(),
        radius,
        shade,
    };
    for row in 1..=set.rows {
        scene.bodies.extend(set.pegs(row).map(|peg| still(peg[0], peg[1], set.peg, 1.0)));
    }
    for ball in board.flying() {
        let lazy = board.engine.lazy(ball);
        scene.bodies.push(Body {
            position: lazy.position.to_three(),
            velocity: lazy.velocity.to_three(),
            time: lazy.time,
            radius: set.ball,
            shade: 0.0,
        });
    }
    let centre = |gap: i32| set.middle() + 0.5 * f64::from(gap);
    let mut filled = std::collections::BTreeMap::<i32, usize>::new();
    for ball in board.landed() {
        let gap = ball.gap(set.rows);
        let count = filled.entry(gap).or_default();
        let [x, y] = bins.place(*count, set.ball);
        let fallen = scene.time - ball.time;
        let height = -fallen * (LEAVING + 0.5 * fallen);
        scene.bodies.push(still(centre(gap) + x, height.max(y), set.ball, 0.0));
        *count += 1;
    }
    let mut line = |from: [f64; 2], to: [f64; 2], width: f32, colour: Colour| {
        scene.lines.push(Line { from: [from[0], from[1], 0.0], to: [to[0], to[1], 0.0], width, colour });
    };
    let (left, right) = (-set.ball, set.width() + set.ball);
    line([left, -bins.depth], [right, -bins.depth], 2.5, Colour::Wall);
    for x in [left, right] {
        line([x, -bins.depth], [x, set.top()], 2.5, Colour::Wall);
    }
    let reach = set.width() as i32 - 1;
    for gap in (-reach..=reach).filter(|gap| (gap - set.rows as i32) % 2 == 0) {
        let x = centre(gap) - 0.5;
        line([x, -bins.depth], [x, 0.0], 1.0, Colour::Faint);
    }
    // How high fair and forgetful pegs would fill the bins with as many balls.
    let scale = board.landed().len() as f64 / bins.beside as f64 * bins.layer;
    let height = |gap: i32| scale * binomial(set.rows, gap) - bins.depth;
    let rows = set.rows as i32;
    for gap in (-rows..rows).step_by(2) {
        line([centre(gap), height(gap)], [centre(gap + 2), height(gap + 2)], 2.0, Colour::Accent(5));
    }
    scene.colouring = Colouring::Species(vec!["ball".into(), "peg".into()]);
    scene.camera = Camera::fit([left, -bins.depth, 0.0], [right, set.top() + 0.5, 0.0]);
    scene.bounds = Some([[left, -bins.depth, 0.0], [right, set.top(), 0.0]]);
}

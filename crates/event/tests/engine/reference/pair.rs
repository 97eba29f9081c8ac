//! Wells and growth in the plain engine: quadratics solved the schoolbook way.

use corpuscle_core::Vector;
use corpuscle_event::Pair;

use super::Reference;

impl<const D: usize> Reference<D> {
    /// Where the well of a pair ends; nowhere if there is none.
    pub(super) fn edge(&self, i: usize, j: usize) -> f64 {
        let s = self.particles.radius[i] + self.particles.radius[j];
        if let Pair::Well { range, .. } = self.rules.pair { range * s } else { 0.0 }
    }

    /// When the cores of a pair touch: where the square of the distance, less that of the contact distance, falls through
    /// zero.
    pub(super) fn core_delay(&self, i: usize, j: usize, shift: Vector<D>) -> f64 {
        let p = &self.particles;
        let (r, v) = (p.position[j] + shift - p.position[i], p.velocity[j] - p.velocity[i]);
        let s = (p.radius[i] + p.radius[j]) * self.scale;
        let g = (p.radius[i] + p.radius[j]) * self.growth;
        let (a, b, c) = (v.dot(v) - g * g, r.dot(v) - s * g, r.dot(r) - s * s);
        if c <= 1e-12 * s * s && b < 0.0 {
            return 0.0;
        }
        let falls = |t: f64| a * t + b < 0.0;
        let crossings = roots(a, b, c).into_iter().filter(|&t| t > 1e-12 && falls(t));
        crossings.fold(f64::INFINITY, f64::min)
    }

    /// When a pair comes to the edge of its well, from the side it is on.
    pub(super) fn edge_delay(&self, i: usize, j: usize, shift: Vector<D>) -> f64 {
        let p = &self.particles;
        let edge = self.edge(i, j);
        let (r, v) = (p.position[j] + shift - p.position[i], p.velocity[j] - p.velocity[i]);
        if edge == 0.0 {
            return f64::INFINITY;
        }
        // Of all images of a partner, that one is inside which is within the edge, give or take rounding.
        let inside = self.bonds[i][j] && r.norm() < edge * (1.0 + 1e-9);
        let (a, b, c) = (v.dot(v), r.dot(v), r.dot(r) - edge * edge);
        let rounding = 1e-12 * edge * edge;
        if inside && c > -rounding && b > 0.0 || !inside && c < rounding && b < 0.0 {
            return 0.0;
        }
        let outwards = |t: f64| a * t + b > 0.0;
        roots(a, b, c).into_iter().filter(|&t| t > 0.0 && outwards(t) == inside).fold(f64::INFINITY, f64::min)
    }

    /// A step of the potential: the kinetic energy of the motion along `k` pays for it, or the pair turns round.
    pub(super) fn cross(&mut self, i: usize, j: usize, k: Vector<D>) {
        let Pair::Well { depth, .. } = self.rules.pair else { return };
        let p = &mut self.particles;
        let mu = p.mass[i] * p.mass[j] / (p.mass[i] + p.mass[j]);
        let inside = self.bonds[i][j];
        let before = (p.velocity[j] - p.velocity[i]).dot(k);
        let energy = 0.5 * mu * before * before + if inside { -depth } else { depth };
        let after = if energy >= 0.0 { (2.0 * energy / mu).sqrt() * before.signum() } else { -before };
        if energy >= 0.0 {
            (self.bonds[i][j], self.bonds[j][i]) = (!inside, !inside);
        }
        let impulse = k * (mu * (after - before));
        let (mi, mj) = (p.mass[i], p.mass[j]);
        p.velocity[i] -= impulse / mi;
        p.velocity[j] += impulse / mj;
    }
}

/// Both roots of `a t^2 + 2 b t + c`, the plain way.
fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let root = b * b - a * c;
    if root < 0.0 || a == 0.0 { vec![] } else { vec![(-b - root.sqrt()) / a, (-b + root.sqrt()) / a] }
}

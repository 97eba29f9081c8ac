//! An axis of a chart: its range, where its ticks stand and what they say.

use corpuscle_observe::Scale;

use crate::number::superscript;

/// A range on an axis, mapped to `0..=1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    scale: Scale,
    least: f64,
    most: f64,
}

/// A tick: its value, and its text unless it is a minor one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) text: Option<String>,
}

impl Range {
    /// The range of these values with a margin, a share of the whole at either end; values an axis of this scale cannot
    /// show are ignored.
    pub(super) fn of(scale: Scale, values: impl Iterator<Item = f64>, margin: f64) -> Self {
        let shown = values.filter(|&value| shows(scale, value));
        let (least, most) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        let (least, most) = match scale {
            Scale::Linear if least > most => (0.0, 1.0),
            Scale::Linear => {
                // A single value, or values that differ by rounding only, get a range of their own magnitude.
                let size = least.abs().max(most.abs());
                let differ = most - least > (1e-12 * size).max(1e-290);
                let span = if differ { (most - least) * margin } else { (0.1 * size).max(1e-280) };
                (least - span, most + span)
            }
            Scale::Logarithmic if least > most => (0.1, 10.0),
            Scale::Logarithmic => {
                let ratio = (most / least).powf(margin).max(1.05);
                (least / ratio, most * ratio)
            }
        };
        Self { scale, least, most }
    }

    /// The same range, reaching down (up) to zero.
    pub(super) fn including_zero(self) -> Self {
        if self.scale == Scale::Logarithmic {
            return self;
        }
        // The margin beyond zero would be empty paper.
        Self { least: if self.least > 0.0 { 0.0 } else { self.least }, most: if self.most < 0.0 { 0.0 } else { self.most }, ..self }
    }

    pub(super) fn least(self) -> f64 {
        self.least
    }

    pub(super) fn most(self) -> f64 {
        self.most
    }

    /// Place of a value, 0 at the lower end, 1 at the upper; none when the scale has no place for it. Values far outside
    /// are held near, so that a path that leaves the chart keeps numbers a drawing program can take.
    pub(super) fn place(self, value: f64) -> Option<f64> {
        let place = match self.scale {
            _ if !shows(self.scale, value) => return None,
            Scale::Linear => (value - self.least) / (self.most - self.least),
            Scale::Logarithmic => (value / self.least).ln() / (self.most / self.least).ln(),
        };
        place.is_finite().then(|| place.clamp(-3.0, 4.0))
    }

    /// About `count` ticks, and the power of ten taken out of their texts.
    pub(super) fn ticks(self, count: usize) -> (Vec<Tick>, i32) {
        match self.scale {
            Scale::Linear => self.linear_ticks(count),
            Scale::Logarithmic if (self.most / self.least).log10() < 1.3 => self.linear_ticks(count),
            Scale::Logarithmic => (self.decades(count), 0),
        }
    }

    fn linear_ticks(self, count: usize) -> (Vec<Tick>, i32) {
        let rough = (self.most - self.least) / count.max(1) as f64;
        let power = rough.log10().floor() as i32;
        let unit = power_of_ten(power);
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * unit).into_iter().find(|&step| step >= rough).unwrap_or(rough);
        let size = self.least.abs().max(self.most.abs()).log10().floor() as i32;
        let exponent = if (-3..5).contains(&size) { 0 } else { size };
        let decimals = (exponent - (step * 1.001).log10().floor() as i32).clamp(0, 17) as usize;
        let first = (self.least / step).ceil() as i64;
        let last = (self.most / step).floor() as i64;
        let tick = |k: i64| {
            let value = k as f64 * step;
            let text = format!("{:.decimals$}", value / power_of_ten(exponent));
            // Minus zero is zero.
            let text = if k == 0 { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") };
            Tick { value, text: Some(text) }
        };
        // Where the step is lost in the rounding of the values there is nothing to divide.
        let ticks = if last - first <= 4 * count as i64 { (first..=last).map(tick).collect() } else { vec![] };
        (ticks, exponent)
    }

    fn decades(self, count: usize) -> Vec<Tick> {
        let (first, last) = (self.least.log10().floor() as i32, self.most.log10().floor() as i32);
        let every = ((last - first - 1).max(1) as usize).div_ceil(count.max(1)).max(1) as i32;
        let mut ticks = vec![];
        for power in first..=last {
            let unit = power_of_ten(power);
            let text = (power.rem_euclid(every) == 0).then(|| match power {
                0 => "1".into(),
                1 => "10".into(),
                _ => format!("10{}", superscript(power)),
            });
            ticks.push(Tick { value: unit, text });
            if every == 1 {
                ticks.extend((2..10).map(|digit| Tick { value: f64::from(digit) * unit, text: None }));
            }
        }
        ticks.retain(|tick| self.least <= tick.value && tick.value <= self.most);
        ticks
    }
}

/// Whether an axis of this scale has a place for a value. Values so large or small that a range of them overflows have none.
fn shows(scale: Scale, value: f64) -> bool {
    match scale {
        Scale::Linear => value.abs() < 1e280,
        Scale::Logarithmic => (1e-140..1e140).contains(&value),
    }
}

/// `10^power`, correctly rounded, which repeated multiplication is not.
fn power_of_ten(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(f64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(range: Range) -> (Vec<String>, i32) {
        let (ticks, exponent) = range.ticks(5);
        (ticks.into_iter().filter_map(|tick| tick.text).collect(), exponent)
    }

    #[test]
    fn ticks_are_round_numbers() {
        let linear = |a: f64, b: f64| texts(Range::of(Scale::Linear, [a, b].into_iter(), 0.0));
        assert_eq!(linear(0.0, 1.0).0, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(linear(-30.0, 60.0).0, ["−20", "0", "20", "40", "60"]);
        assert_eq!(linear(0.0, 4e-6), (vec!["0".into(), "1".into(), "2".into(), "3".into(), "4".into()], -6));
        let logarithmic = texts(Range::of(Scale::Logarithmic, [0.05, 2000.0].into_iter(), 0.0)).0;
        assert_eq!(logarithmic, ["10⁻¹", "1", "10", "10²", "10³"]);
    }

    #[test]
    fn odd_ranges_neither_panic_nor_fill_the_paper() {
        for values in
            [[f64::NAN; 2], [0.0; 2], [1e300; 2], [f64::MIN, f64::MAX], [1.0, 1.0 + 1e-15], [5e-324, 1e-323], [-1.0, -2.0]]
        {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                let range = Range::of(scale, values.into_iter(), 0.05);
                let (ticks, _) = range.ticks(6);
                assert!(ticks.len() < 100, "{values:?} {scale:?} {}", ticks.len());
                assert!(ticks.iter().all(|tick| range.place(tick.value).is_some_and(|place| (-0.01..=1.01).contains(&place))));
            }
        }
    }
}

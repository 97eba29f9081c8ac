//! The charts of the melting.

use corpuscle_observe::chart::{Axis, Scale, Series, Style};
use corpuscle_observe::theory::hard_discs;
use corpuscle_observe::{Chart, Estimate};

use super::sheet::{Sample, Start};
use super::{CERTAIN, CRYSTALLINE, Melting};

/// From here on the branch of the crystal is drawn, and up to the other one that of the liquid.
const FROM: f64 = 0.72;
const UP_TO: f64 = 0.69;

/// Both starts with the names they have in every chart.
const STARTS: [(&str, Start); 2] = [("begun as crystals", Start::Crystal), ("begun without order", Start::Disorder)];

impl Melting {
    fn points(&self, number: impl Fn(f64) -> Option<Estimate>) -> Vec<(f64, f64, f64)> {
        let point = |&packing: &f64| number(packing).map(|value| (packing, value.mean, value.standard_error));
        self.packings.iter().filter_map(point).collect()
    }

    fn with_both_starts(&self, chart: Chart, number: impl Fn(f64, Start) -> Option<Estimate>) -> Chart {
        STARTS.into_iter().fold(chart, |chart, (name, start)| {
            let points = self.points(|packing| number(packing, start));
            if points.is_empty() { chart } else { chart.with(Series::with_errors(name, Style::Points, points)) }
        })
    }

    pub(super) fn pressure_chart(&self) -> Chart {
        let (least, most) = (self.packings[0], self.packings[self.packings.len() - 1]);
        let count = self.count;
        let mut chart = Chart::new(
            "pressure",
            "Pressure through the transition",
            Axis::linear("packing fraction", ""),
            Axis::linear("P σ²/kT", ""),
        );
        if least < UP_TO {
            let liquid = |packing: f64| hard_discs::pressure(packing, hard_discs::liquid_of_few(packing, count));
            chart = chart.with(Series::theory("liquid: ten virial coefficients", least, UP_TO, 80, Scale::Linear, liquid));
        }
        chart = chart.with(Series::theory(
            "a million: liquid and hexatic side by side",
            hard_discs::LIQUID,
            hard_discs::HEXATIC,
            2,
            Scale::Linear,
            |_| hard_discs::COEXISTENCE,
        ));
        if most > FROM {
            let crystal = |packing: f64| hard_discs::pressure(packing, hard_discs::crystal_of_few(packing, count));
            chart = chart.with(Series::theory("crystal: free area", FROM, most, 80, Scale::Linear, crystal));
        }
        self.with_both_starts(chart, |packing, start| {
            Some(self.compressibility(packing, Some(start))? * hard_discs::pressure(packing, 1.0))
        })
        .noting("Few discs smear the level piece out; where the starts differ there is no equilibrium yet. Above 0.64 the liquid leaves its virial series.")
    }

    /// What is measured less what is known, where something is.
    pub(super) fn residual_chart(&self) -> Chart {
        let (least, most) = (self.packings[0], self.packings[self.packings.len() - 1]);
        let chart = Chart::new(
            "residuals",
            "Pressure less that of theory",
            Axis::linear("packing fraction", ""),
            Axis::linear("difference of P V/(N k T)", ""),
        )
        .with(Series::theory("agreement", least, most, 2, Scale::Linear, |_| 0.0));
        let known = |packing: f64| {
            if packing <= CERTAIN {
                Some(hard_discs::liquid_of_few(packing, self.count))
            } else {
                (packing >= CRYSTALLINE).then(|| hard_discs::crystal_of_few(packing, self.count))
            }
        };
        self.with_both_starts(chart, |packing, start| {
            Some(self.compressibility(packing, Some(start))? - Estimate::exact(known(packing)?))
        })
        .noting("Where it is known: liquid up to 0.6, crystal from 0.76, of as many discs. The crystal's theory is a fit, good to 0.02.")
    }

    pub(super) fn order_chart(&self) -> Chart {
        // A floor rather than a theory that the points are held against.
        let chance = 0.5 * (std::f64::consts::PI / (6.0 * self.count as f64)).sqrt();
        let (least, most) = (self.packings[0], self.packings[self.packings.len() - 1]);
        let chart =
            Chart::new("order", "Order of directions", Axis::linear("packing fraction", ""), Axis::linear("|ψ₆| of a sheet", ""))
                .with(Series::new("discs that know nothing of each other", Style::Line, [(least, chance), (most, chance)]));
        self.with_both_starts(chart, |packing, start| self.order(packing, start)).noting(
            "Grains that have grown in different directions cancel: a low value above the transition is a crystal in pieces.",
        )
    }

    pub(super) fn susceptibility_chart(&self) -> Chart {
        let chart = Chart::new(
            "susceptibility",
            "How much the order wavers",
            Axis::linear("packing fraction", ""),
            Axis::linear("N (⟨|ψ₆|²⟩ − ⟨|ψ₆|⟩²)", ""),
        );
        self.with_both_starts(chart, |packing, start| self.susceptibility(packing, start))
            .noting("The peak marks the transition. It needs runs that are long against the wavering: settle and watch longer.")
    }

    pub(super) fn time_chart(&self) -> Chart {
        let sheet = &self.shown.members[0];
        let series = |number: fn(&Sample) -> f64| {
            self.shown.times.iter().zip(&sheet.samples).map(move |(&time, sample)| (time, number(sample))).collect::<Vec<_>>()
        };
        Chart::new("time", "The sheet on show", Axis::linear("time t", "σ √(m/kT)"), Axis::linear("order", ""))
            .with(Series::new("of the whole sheet, |ψ₆|", Style::Line, series(|sample| sample.order)))
            .with(Series::new("mean of the discs' own", Style::Line, series(|sample| sample.local)))
            .noting("Near the transition the first wanders for ever so long: that is the time equilibrium takes.")
    }
}

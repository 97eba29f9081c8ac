//! What a wall of the box does besides being hard.

use crate::{Invalid, Motion};

/// One face of the box across an axis with [walls](crate::Axis::Walls): hard, smooth, still, closed and without a
/// temperature unless told otherwise.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Face {
    /// Temperature `kT`: a particle leaves this face as if it came from a gas in equilibrium behind it.
    pub temperature: Option<f64>,
    /// Where the face is, if it moves: at every time within the box, so that the box holds all there is.
    pub motion: Option<Motion>,
    /// Physical time from which on the face is gone, and particles leave the box for ever.
    pub opened_at: Option<f64>,
}

impl Face {
    /// Whether the face is there at this time.
    pub fn stands_at(&self, time: f64) -> bool {
        self.opened_at.is_none_or(|opened| time < opened)
    }

    pub(super) fn validate(&self, lower: f64, upper: f64) -> Result<(), Invalid> {
        if let Some(temperature) = self.temperature
            && !(temperature > 0.0 && temperature.is_finite())
        {
            return Err(Invalid::new("temperature of a face", temperature, "a positive number"));
        }
        if let Some(motion) = &self.motion {
            motion.validate()?;
            let (from, to) = motion.range();
            if !(lower <= from && to <= upper) {
                return Err(Invalid::new(
                    "motion of a face",
                    format!("between {from} and {to}"),
                    format!("a motion within the box, {lower} to {upper}"),
                ));
            }
        }
        if self.opened_at.is_some_and(f64::is_nan) {
            return Err(Invalid::new("opened_at", f64::NAN, "a time"));
        }
        Ok(())
    }
}

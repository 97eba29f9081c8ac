//! Run-time choice of the instruction set.

/// Work that is compiled once for each instruction set. `run` must be `#[inline(always)]`, and so must what it calls: only
/// then does the compiler use the instructions of the function it ends up in.
pub(crate) trait Kernel {
    type Output;

    fn run(self) -> Self::Output;
}

/// Instruction sets kernels are compiled for. All give the same bits: kernels use no fused operations, and their sums do
/// not depend on the order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Instructions {
    /// What every machine of the target has.
    Plain,
    /// 256-bit vectors.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 256-bit vectors with masks and 32 registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Instructions {
    /// The best this machine has.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") && is_x86_feature_detected!("avx512vl") {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Plain
    }

    /// Every one this machine has.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        let mut all = vec![Self::Plain];
        #[cfg(target_arch = "x86_64")]
        {
            if Self::detect() != Self::Plain {
                all.push(Self::Avx2);
            }
            if Self::detect() == Self::Avx512 {
                all.push(Self::Avx512);
            }
        }
        all
    }

    /// Runs `kernel`, compiled for this instruction set.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Plain => kernel.run(),
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "the one way into code for an instruction set chosen at run time")]
            // SAFETY: `detect` and `all` make these values only where the machine has the instructions.
            Self::Avx2 => unsafe { with_avx2(kernel) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code, reason = "the one way into code for an instruction set chosen at run time")]
            // SAFETY: as above.
            Self::Avx512 => unsafe { with_avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
fn with_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

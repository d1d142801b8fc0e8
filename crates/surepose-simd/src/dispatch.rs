//! Runtime dispatch of kernels to the best instruction set.

use std::sync::OnceLock;

/// A computation worth vector instructions.
pub trait Kernel {
    /// Result type.
    type Output;

    /// Runs the computation.
    ///
    /// `run` and everything that it calls must be `#[inline(always)]`. A function that is not inlined is
    /// compiled only for the baseline instruction set.
    fn run(self) -> Self::Output;
}

/// Adapter that lets `pulp` inline the kernel for each instruction set.
struct Inlined<W>(W);

impl<W: Kernel> pulp::NullaryFnOnce for Inlined<W> {
    type Output = W::Output;

    #[inline(always)]
    fn call(self) -> W::Output {
        self.0.run()
    }
}

/// Instruction sets of [`dispatch_simd`], the widest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InstructionSet {
    Avx512,
    Avx2,
    Portable,
}

/// The widest instruction set of the processor that `SUREPOSE_SIMD` allows: `avx512` (default), `avx2` or `portable`.
fn selected() -> InstructionSet {
    static SELECTED: OnceLock<InstructionSet> = OnceLock::new();
    *SELECTED.get_or_init(|| select(std::env::var("SUREPOSE_SIMD").ok().as_deref()))
}

fn select(widest: Option<&str>) -> InstructionSet {
    #[cfg(target_arch = "x86_64")]
    {
        let allows_avx2 = widest != Some("portable");
        let allows_avx512 = allows_avx2 && widest != Some("avx2");
        if allows_avx512 && pulp::x86::V4::try_new().is_some() {
            return InstructionSet::Avx512;
        }
        if allows_avx2 && pulp::x86::V3::try_new().is_some() {
            return InstructionSet::Avx2;
        }
    }
    let _ = widest;
    InstructionSet::Portable
}

/// Runs `work` with the widest vector instructions of the processor, or those that the variable `SUREPOSE_SIMD` selects.
pub fn dispatch_simd<W: Kernel>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    {
        use pulp::Simd;
        let set = selected();
        if set == InstructionSet::Avx512
            && let Some(avx512) = pulp::x86::V4::try_new()
        {
            return Simd::vectorize(avx512, Inlined(work));
        }
        if set == InstructionSet::Avx2
            && let Some(avx2) = pulp::x86::V3::try_new()
        {
            return Simd::vectorize(avx2, Inlined(work));
        }
    }
    work.run()
}

/// Name of the instruction set that [`dispatch_simd`] selects, for reports.
pub fn instruction_set() -> &'static str {
    match selected() {
        InstructionSet::Avx512 => "AVX-512",
        InstructionSet::Avx2 => "AVX2",
        InstructionSet::Portable => "portable",
    }
}

/// Runs `work` with the baseline instruction set; used by tests.
pub fn dispatch_portable<W: Kernel>(work: W) -> W::Output {
    work.run()
}

#[cfg(test)]
mod tests {
    use super::{InstructionSet, select};

    /// A name that selects nothing leaves the choice to the processor.
    #[test]
    fn instruction_set_is_never_wider_than_selected() {
        assert_eq!(select(Some("portable")), InstructionSet::Portable);
        assert_ne!(select(Some("avx2")), InstructionSet::Avx512);
        assert_eq!(select(Some("avx512")), select(None));
    }
}

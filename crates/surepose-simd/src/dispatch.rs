//! Runtime dispatch of kernels to the best instruction set.

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

/// Runs `work` with the widest vector instructions of the processor.
pub fn dispatch_simd<W: Kernel>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    {
        use pulp::Simd;
        if let Some(avx512) = pulp::x86::V4::try_new() {
            return Simd::vectorize(avx512, Inlined(work));
        }
        if let Some(avx2) = pulp::x86::V3::try_new() {
            return Simd::vectorize(avx2, Inlined(work));
        }
    }
    work.run()
}

/// Name of the instruction set that [`dispatch_simd`] selects, for reports.
pub fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if pulp::x86::V4::try_new().is_some() {
            return "AVX-512";
        }
        if pulp::x86::V3::try_new().is_some() {
            return "AVX2";
        }
    }
    "portable"
}

/// Runs `work` with the baseline instruction set; used by tests.
pub fn dispatch_portable<W: Kernel>(work: W) -> W::Output {
    work.run()
}

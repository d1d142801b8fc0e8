//! Work compiled once for each instruction set, and the choice among them when it starts.

/// Work worth vector instructions.
pub trait Kernel {
    /// What it gives.
    type Output;

    /// Does the work. To be compiled for each instruction set, `run` and what it calls must be `#[inline(always)]`:
    /// a function that is called, not inlined, is compiled for the plainest processor only.
    fn run(self) -> Self::Output;
}

/// What `pulp` inlines into its function for each instruction set.
struct Inlined<W>(W);

impl<W: Kernel> pulp::NullaryFnOnce for Inlined<W> {
    type Output = W::Output;

    #[inline(always)]
    fn call(self) -> W::Output {
        self.0.run()
    }
}

/// Does `work` with the widest vectors the processor has.
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

/// The name of what [`dispatch_simd`] chooses here, for reports.
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

/// Does `work` as [`dispatch_simd`] does where there is nothing wide: for tests.
pub fn dispatch_portable<W: Kernel>(work: W) -> W::Output {
    work.run()
}

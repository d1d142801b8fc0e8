//! Cortex-M4F: entry point, output and clock.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{debug, hprintln};
use panic_semihosting as _;

use crate::parking;

/// Runs the loop, prints the result as the host does, and then the time per step.
#[cortex_m_rt::entry]
fn main() -> ! {
    if let Some(mut peripherals) = cortex_m::Peripherals::take() {
        start(&mut peripherals.SYST);
    }
    let (mut spent, mut begun) = (0_u64, None);
    let parked = parking::park(|| match begun.take() {
        None => begun = Some(SYST::get_current()),
        // The counter has 24 bits and counts down.
        Some(begun) => spent += u64::from(begun.wrapping_sub(SYST::get_current()) & WIDTH),
    });
    hprintln!("{}", parked);
    hprintln!("instructions per tick {}", spent * INSTRUCTIONS_PER_CYCLE / u64::from(parked.ticks));
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}

/// Emulated clock of 25 MHz; the emulator counts 1 ns per instruction.
const INSTRUCTIONS_PER_CYCLE: u64 = 40;

const WIDTH: u32 = 0x00ff_ffff;

fn start(clock: &mut SYST) {
    clock.set_clock_source(SystClkSource::Core);
    clock.set_reload(WIDTH);
    clock.clear_current();
    clock.enable_counter();
}

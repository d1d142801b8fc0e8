//! Closed loop on a microcontroller and on the host; `cargo xtask microcontroller` compares their bits.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[path = "../../crates/surepose/examples/firmware_loop/parking.rs"]
mod parking;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("{}", parking::park(|| ()));
}

//! `surepose calibrate`: exit codes of what cannot be calibrated from.

mod common;

use common::surepose;

#[test]
fn what_is_no_recording_is_named_with_exit_code_3() {
    let file = std::env::temp_dir().join("surepose-calibrate-broken.dat");
    std::fs::write(&file, "0 0 nan 3\n").unwrap();
    let path = file.to_string_lossy().into_owned();
    let broken = surepose(&["calibrate", "ticks", &path]);
    assert_eq!(broken.code, 3, "{}", broken.stderr);
    assert!(broken.stderr.contains("surepose-calibrate-broken.dat:1"), "{}", broken.stderr);
    assert_eq!(surepose(&["calibrate", "ticks", "no-such-recording.dat"]).code, 3);
    assert_eq!(surepose(&["calibrate", "tocks", &path]).code, 2);
}

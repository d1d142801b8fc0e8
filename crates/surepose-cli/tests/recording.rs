//! `run --record` and the replay of its recordings.

mod common;

use common::{folder, surepose};

#[test]
fn recorded_run_replays_to_the_bit_and_a_changed_gain_is_named() {
    let path = folder("recording").join("drive").display().to_string();
    let alone = surepose(&["run", "--json"]);
    let recorded = surepose(&["run", "--record", &path, "--json"]);
    assert_eq!((recorded.code, recorded.json()), (alone.code, alone.json()), "recording changed the run");

    let replayed = surepose(&["replay", "mcap", &path, "--json"]);
    assert_eq!((replayed.code, &replayed.json()["bit_identical"]), (0, &true.into()), "{}", replayed.stdout);

    let changed = surepose(&["replay", "mcap", &path, "--set", "law.k_v=3", "--json"]);
    let json = changed.json();
    assert_eq!((changed.code, &json["first_difference"]["field"]), (1, &"command.v".into()), "{json}");
    assert_eq!(json["configuration"][0]["key"], "law.k_v", "{json}");

    let unused = surepose(&["replay", "mcap", &path, "--compass"]);
    assert!(unused.code == 2 && unused.stderr.contains("--compass"), "{}: {}", unused.code, unused.stderr);

    let again = surepose(&["run", "--record", &path]);
    assert!(again.code == 2 && again.stderr.contains("--record"), "{}: {}", again.code, again.stderr);
}

#[test]
fn comparison_needs_a_recording_of_the_recorder() {
    let run = surepose(&["replay", "carmen", "absent.log", "--against", "absent"]);
    assert!(run.code == 2 && run.stderr.contains("--against"), "{}: {}", run.code, run.stderr);
}

//! Recordings of the driver are replayed to the bit, whatever calls they hold.

use surepose_recorder::FlightRecorder;
use surepose_recorder::replay::replay;

use super::*;

#[test]
fn recorded_drive_with_every_call_replays_to_the_bit() {
    let folder = std::env::temp_dir().join(format!("surepose-driver-recording-{}", std::process::id()));
    drop(std::fs::remove_dir_all(&folder));
    let mut ride = Ride::new(false, 0.05);
    let recorder = FlightRecorder::create(&folder, &ride.driver.settings.session()).unwrap();
    ride.driver = ride.driver.clone().recorded_by(recorder.handle());

    // Global localization, a drive that is interrupted, a given pose, a changed mounting, and a second goal.
    ride.live(0.5);
    ride.driver.set_goal(goal()).unwrap();
    ride.live(15.0);
    ride.driver.cancel();
    ride.live(1.0);
    let known = Stamped::new(ride.driver.belief_stamp(), Belief::new(ride.world.pose(), [0.05; 3]));
    ride.driver.set_pose(known);
    ride.live(0.5);
    ride.driver.on_mounting_changed();
    ride.driver.set_goal(Pose::new(1.5, 1.0, Angle::from_degrees(90.0))).unwrap();
    ride.live(3.0);
    assert!(ride.driver.on_odometry_timeout(1000.0).0);
    ride.driver.start_global_localization();
    ride.driver.set_goal(goal()).unwrap();
    ride.live(20.0);

    let summary = recorder.finish().unwrap();
    assert_eq!(summary.dropped, 0);
    let replayed = replay(&folder, None, |config| config).unwrap().unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(replayed.bit_identical && replayed.complete, "{replayed:?}");
    assert!(replayed.steps > 300, "{replayed:?}");
}

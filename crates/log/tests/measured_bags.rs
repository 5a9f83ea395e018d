//! Bags that robots wrote, against figures read from them by another program (30 lines of Python that
//! know the record layout of bags and the offsets within these messages, and no definitions).

use grouser_log::container::{Container, Event};
use grouser_log::message::Decoder;
use grouser_log::{Error, Survey, Use, series};

use crate::measured_data::measured_data;

#[test]
fn the_jackal_has_a_yaw_rate_and_odometry() {
    let Some(path) = measured_data("jackal/jackal_61s.bag") else {
        return;
    };
    let survey = Survey::read(&path, |_| ()).unwrap();
    assert_eq!(survey.damage_count, 0, "{:?}", survey.damages);
    assert_eq!(survey.first_ns, Some(47_580_000_000));
    assert_eq!(survey.last_ns, Some(108_781_000_000));
    let found: Vec<_> = survey
        .topics
        .iter()
        .map(|t| (t.channel.topic.as_str(), t.messages, t.undecoded, t.use_for))
        .collect();
    assert_eq!(
        found,
        [
            ("/imu/data", 3061, 0, Some(Use::YawRate)),
            (
                "/jackal_velocity_controller/odom",
                3060,
                0,
                Some(Use::Motion)
            ),
        ]
    );
}

#[test]
fn the_plates_force_is_read_by_the_definition_in_its_bag() {
    let plates = [
        (
            1,
            3004,
            -186.540_969_848_632_8,
            40.383_972_167_968_75,
            10_403_847,
        ),
        (
            4,
            3108,
            -339.880_126_953_125,
            40.560_371_398_925_78,
            10_252_411,
        ),
    ];
    for (number, count, least, temperature, longest_ns) in plates {
        let name = format!("cmu-wheel/f-d-large-box__force-displacement_{number}.bag");
        let Some(path) = measured_data(&name) else {
            return;
        };
        let mut container = Container::open(&path).unwrap();
        let (mut decoder, mut force, mut last) = (None, f64::INFINITY, 0.0);
        while let Some(event) = container.next() {
            let Event::Message(message) = event else {
                panic!("{event:?}");
            };
            assert_eq!(message.of.type_name, "rokubimini_msgs/Reading");
            let decoder = decoder.get_or_insert_with(|| Decoder::new(message.of).unwrap());
            let value = decoder.decode(message.data).unwrap();
            let number = |path: &str| value.at(path).unwrap().number().unwrap();
            force = force.min(number("wrench.wrench.force.z"));
            last = number("temperature");
        }
        assert_eq!((force, last), (least, temperature));
        // The same as a series over time.
        let topic = "/rokubimini_cosmo/forcetorque_readings";
        let force_z = series(&path, topic, "wrench.wrench.force.z").unwrap();
        assert_eq!(force_z.samples.len() as u64, count);
        let lowest = force_z
            .samples
            .iter()
            .map(|s| s.1)
            .fold(f64::INFINITY, f64::min);
        assert_eq!(lowest, least);
        assert!(force_z.samples.is_sorted_by(|a, b| a.0 <= b.0));
        let wrong = series(&path, topic, "wrench.force.z").unwrap_err();
        assert!(matches!(wrong, Error::NoField { .. }), "{wrong}");
        let wrong = series(&path, "/rokubimini_cosmo/forcetorque_reading", "x").unwrap_err();
        assert_eq!(wrong.hint().unwrap(), format!("did you mean `{topic}`?"));
        // Recorded in bursts, every 40 ms, but taken every 10 ms without a gap.
        let survey = Survey::read(&path, |_| ()).unwrap();
        let topic = &survey.topics[0];
        assert_eq!(
            (topic.messages, topic.stamped, topic.gaps),
            (count, true, 0)
        );
        assert_eq!(topic.longest_s, f64::from(longest_ns) * 1e-9);
    }
}

//! The soils that a robot chooses between, as tables.

use alloc::{boxed::Box, format, vec::Vec};

use grouser_terra::{Kinematics, RigidWheel, Settings as LawSettings, Slip, Soil, WheelOnSoil};

use super::super::settings::WheelSetup;
use super::contact::leads;
use crate::error::{Error, Result, check_range};
use crate::prior::{STIFFNESSES, STRENGTHS, scaled_soil};
use crate::robot::Robot;

/// Soils of a family.
pub const LEVELS: usize = STRENGTHS.len() * STIFFNESSES.len();
/// Points of a table over slip.
pub const SLIP_POINTS: usize = 29;
/// The least slip of a table: braking beyond it is not learnt from.
const MIN_SLIP: f64 = -0.4;
/// Slip between two points.
const SLIP_STEP: f64 = 0.05;
/// No wheel's load is taken below this, N: the laws need a load.
const MIN_LOAD_N: f64 = 0.1;

/// A quantity at slips −0.4, −0.35, … 1, linear between them.
pub type SlipTable = [f64; SLIP_POINTS];

/// One soil: what it gives the robot whose powered wheels run at one slip, each under their mean load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilMember {
    /// Cohesion and tan φ as multiples of the known soil's.
    pub strength: f64,
    /// Pressure-sinkage moduli as multiples of the known soil's.
    pub stiffness: f64,
    /// Pull of all wheels over the load of all wheels: that of the powered ones less the resistance of the free ones.
    pub pulls: SlipTable,
    /// Torque of a powered wheel over its load and radius.
    pub torques: SlipTable,
    /// Sinkage of a powered wheel that leads, over its radius, under the load of such a wheel.
    pub sinkages: SlipTable,
}

/// The known soil at four strengths and four stiffnesses.
///
/// [`SoilFamily::solve`] makes it from the laws of terra; a microcontroller takes a ready-made one: plain numbers.
///
/// ```
/// use grouser_slip::onboard::{SoilFamily, WheelSetup};
/// use grouser_slip::{Robot, Wheel};
/// use grouser_terra::catalogue;
///
/// let wheel = Wheel::powered("drive").radius(0.125).ticks_per_turn(1000);
/// let robot = Robot::new("one wheel".into(), vec![wheel])?;
/// let mut setup = WheelSetup::default();
/// (setup.load, setup.max_torque) = (80.0, Some(10.0)); // N, N m
/// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let family = SoilFamily::solve(&robot, &[setup], &sand)?;
/// let members = family.members();
/// // of soils as stiff, the stronger one pulls more at a slip of 0.3
/// let pull = |member: usize| members[member].pulls[14];
/// assert!((4..16).all(|member| pull(member) > pull(member - 4)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SoilFamily {
    members: Box<[SoilMember]>,
    /// tan φ of the known soil.
    friction: f64,
}

impl SoilFamily {
    /// The family of `soil` for the powered wheels of `robot`, which are like the first of them under their mean load.
    ///
    /// # Errors
    /// [`Error::Law`] where the laws refuse the wheel, the load or a soil; [`Error::OutOfRange`] for a robot without a
    /// powered wheel.
    pub fn solve(robot: &Robot, setups: &[WheelSetup], soil: &Soil) -> Result<Self> {
        let wheels = robot.wheels().iter().zip(setups);
        let powered: Vec<_> = wheels
            .filter(|(_, setup)| setup.max_torque.is_some())
            .collect();
        let count = powered.len() as f64;
        check_range("soil learning", "powered wheels", count, (1.0, 1e3), "1")?;
        let load = powered.iter().map(|(_, setup)| setup.load).sum::<f64>() / count;
        let wheel = powered[0].0;
        let law = |source| Error::Law {
            of: format!("wheel \"{}\"", wheel.name),
            source,
        };
        let rigid = wheel
            .rigid(wheel.width.unwrap_or(wheel.radius))
            .map_err(law)?;
        let mut free = Vec::new();
        for (wheel, setup) in robot.wheels().iter().zip(setups) {
            if setup.max_torque.is_none() && setup.load > MIN_LOAD_N {
                let rigid = wheel
                    .rigid(wheel.width.unwrap_or(wheel.radius))
                    .map_err(law)?;
                free.push((rigid, setup.load, setup.bearing_torque));
            }
        }
        let load = load.max(MIN_LOAD_N);
        let leading_load = leading_load(robot, setups).unwrap_or(load).max(MIN_LOAD_N);
        let all = count * load + free.iter().map(|wheel| wheel.1).sum::<f64>();
        let mut members = Vec::with_capacity(LEVELS);
        for strength in STRENGTHS {
            for stiffness in STIFFNESSES {
                let scaled = scaled_soil(soil, strength, stiffness).map_err(|source| {
                    let of = format!("soil at strength {strength} and stiffness {stiffness}");
                    Error::Law { of, source }
                })?;
                let (mut pulls, torques) = tables(rigid, &scaled, load).map_err(law)?;
                let sinkages = sinkages(rigid, &scaled, leading_load).map_err(law)?;
                let mut resistance = 0.0;
                for wheel in &free {
                    resistance += free_resistance(*wheel, &scaled).map_err(law)?;
                }
                for pull in &mut pulls {
                    *pull = (count * load * *pull - resistance) / all;
                }
                members.push(SoilMember {
                    strength,
                    stiffness,
                    pulls,
                    torques,
                    sinkages,
                });
            }
        }
        let friction = soil.params().phi.rad();
        Ok(Self {
            members: members.into_boxed_slice(),
            friction: grouser_real::Real::tan(friction),
        })
    }

    /// A family that is ready-made, with tan φ of the known soil.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless there are 16 members in the order of [`SoilFamily::members`] with finite tables.
    pub fn from_members(members: &[SoilMember], friction: f64) -> Result<Self> {
        const OF: &str = "soil family";
        let count = LEVELS as f64;
        check_range(OF, "members", members.len() as f64, (count, count), "1")?;
        check_range(OF, "friction", friction, (0.0, 10.0), "1")?;
        for (index, member) in members.iter().enumerate() {
            let level = STRENGTHS[index / STIFFNESSES.len()];
            check_range(OF, "strength", member.strength, (level, level), "1")?;
            let level = STIFFNESSES[index % STIFFNESSES.len()];
            check_range(OF, "stiffness", member.stiffness, (level, level), "1")?;
            for value in member.pulls.iter().chain(&member.torques) {
                check_range(OF, "share of the load", *value, (-100.0, 100.0), "1")?;
            }
            for value in member.sinkages {
                check_range(OF, "sinkage over radius", value, (0.0, 2.0), "1")?;
            }
        }
        Ok(Self {
            members: members.into(),
            friction,
        })
    }

    /// The members: rising strength, and of one strength rising stiffness.
    #[must_use]
    pub fn members(&self) -> &[SoilMember] {
        &self.members
    }

    /// tan φ of the known soil.
    #[must_use]
    pub const fn friction(&self) -> f64 {
        self.friction
    }

    /// The known soil itself.
    pub(super) fn known(&self) -> Option<&SoilMember> {
        let mut members = self.members.iter();
        members.find(|member| member.strength == 1.0 && member.stiffness == 1.0)
    }
}

/// Pull over load, and torque over load and radius. Where the soil carries the load at no sinkage the last value holds.
fn tables(
    wheel: RigidWheel,
    soil: &Soil,
    load: f64,
) -> grouser_terra::Result<(SlipTable, SlipTable)> {
    let contact = WheelOnSoil::new(wheel, *soil, LawSettings::default())?;
    let (mut pulls, mut torques) = ([0.0; SLIP_POINTS], [0.0; SLIP_POINTS]);
    let mut last = (0.0, 0.0);
    for (index, (pull, torque)) in pulls.iter_mut().zip(&mut torques).enumerate() {
        let found = contact.under_load(load, &Kinematics::straight(Slip::new(slip_at(index))?))?;
        if let Some(point) = found.point() {
            let forces = &point.forces;
            last = (
                forces.drawbar_pull / load,
                forces.torque / (load * wheel.radius()),
            );
        }
        (*pull, *torque) = last;
    }
    Ok((pulls, torques))
}

/// Sinkage over radius; as for [`tables`] the last value holds where there is none.
fn sinkages(wheel: RigidWheel, soil: &Soil, load: f64) -> grouser_terra::Result<SlipTable> {
    let contact = WheelOnSoil::new(wheel, *soil, LawSettings::default())?;
    let mut out = [0.0; SLIP_POINTS];
    let mut last = 0.0;
    for (index, sinkage) in out.iter_mut().enumerate() {
        let found = contact.under_load(load, &Kinematics::straight(Slip::new(slip_at(index))?))?;
        if let Some(point) = found.point() {
            last = point.sinkage / wheel.running_radius();
        }
        *sinkage = last;
    }
    Ok(out)
}

/// Mean load of the powered wheels that lead, N.
fn leading_load(robot: &Robot, setups: &[WheelSetup]) -> Option<f64> {
    let wheels = robot.wheels();
    let pairs = wheels.iter().zip(setups);
    let (mut sum, mut count) = (0.0, 0.0);
    for (_, setup) in
        pairs.filter(|(wheel, setup)| setup.max_torque.is_some() && leads(wheel, wheels))
    {
        sum += setup.load;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

/// Resistance (N) of a free wheel under a load (N) with a bearing's torque (N m); one that the soil does not turn slides.
fn free_resistance(
    (wheel, load, bearing): (RigidWheel, f64, f64),
    soil: &Soil,
) -> grouser_terra::Result<f64> {
    let contact = WheelOnSoil::new(wheel, *soil, LawSettings::default())?;
    let slip = match contact.free_slip(load, bearing)? {
        Some(slip) => slip,
        None => Slip::new(-1.0)?,
    };
    let found = contact.under_load(load, &Kinematics::straight(slip))?;
    Ok(found
        .point()
        .map_or(0.0, |point| -point.forces.drawbar_pull))
}

/// The slip of a point.
pub(super) fn slip_at(index: usize) -> f64 {
    (MIN_SLIP + SLIP_STEP * index as f64).min(1.0)
}

/// A table's value and derivative at a slip.
pub(super) fn value_at(table: &SlipTable, slip: f64) -> (f64, f64) {
    let place = (slip.clamp(MIN_SLIP, 1.0) - MIN_SLIP) / SLIP_STEP;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the slip is held within the table"
    )]
    let low = (place as usize).min(SLIP_POINTS - 2);
    let step = table[low + 1] - table[low];
    (table[low] + (place - low as f64) * step, step / SLIP_STEP)
}

impl SoilMember {
    /// The slip at which it gives this pull (over load), and the derivative of the pull there; `None` where no slip does.
    pub(super) fn slip_of_pull(&self, pull: f64) -> Option<(f64, f64)> {
        if pull <= self.pulls[0] {
            return Some((MIN_SLIP, (self.pulls[1] - self.pulls[0]) / SLIP_STEP));
        }
        let index = self.pulls.windows(2).position(|pair| pull <= pair[1])?;
        let step = self.pulls[index + 1] - self.pulls[index];
        let share = (pull - self.pulls[index]) / step;
        Some((slip_at(index) + share * SLIP_STEP, step / SLIP_STEP))
    }

    /// The greatest pull over load.
    pub(super) fn max_pull(&self) -> f64 {
        self.pulls.iter().copied().fold(f64::MIN, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use alloc::{format, vec::Vec};

    use super::*;
    use crate::robot::Wheel;

    /// The family on dry sand of wheels at (x, y) under a load (N), the free ones with a width of 0.05 m.
    fn family(wheels: &[(f64, f64, f64, bool)]) -> SoilFamily {
        let setups: Vec<WheelSetup> = (wheels.iter())
            .map(|(_, _, load, is_free)| WheelSetup {
                load: *load,
                max_torque: (!is_free).then_some(10.0),
                ..WheelSetup::default()
            })
            .collect();
        let wheels = wheels
            .iter()
            .enumerate()
            .map(|(index, (x, y, _, is_free))| {
                let name = format!("wheel {index}");
                let wheel = if *is_free {
                    Wheel::free(name).width(0.05)
                } else {
                    Wheel::powered(name).width(0.1)
                };
                wheel.at(*x, *y).radius(0.1)
            });
        let robot = Robot::new("cart".into(), wheels.collect()).expect("a robot");
        let sand = grouser_terra::catalogue::find("dry-sand").expect("a soil");
        SoilFamily::solve(&robot, &setups, &sand.soil().expect("a soil")).expect("a family")
    }

    const FRONT: [(f64, f64, f64, bool); 2] = [(0.3, 0.2, 50.0, false), (0.3, -0.2, 50.0, false)];

    fn with_free(loads: &[f64]) -> SoilFamily {
        let free = loads.iter().enumerate();
        let free = free.map(|(index, load)| (-0.3, index as f64, *load, true));
        family(&FRONT.into_iter().chain(free).collect::<Vec<_>>())
    }

    #[test]
    fn wheels_that_lead_sink_under_their_own_mean_load() {
        // 40 and 60 N in front, and a wheel in the rut of one of them that does not count
        let wheels = [
            (0.3, 0.2, 40.0, false),
            (0.3, -0.2, 60.0, false),
            (-0.3, 0.2, 80.0, false),
        ];
        for (found, expected) in family(&wheels)
            .members()
            .iter()
            .zip(family(&FRONT).members())
        {
            assert_eq!(found.sinkages, expected.sinkages);
            assert!(found.pulls != expected.pulls);
        }
    }

    #[test]
    fn where_no_powered_wheel_leads_they_sink_under_their_mean_load() {
        // free wheels without a load roll ahead of wheels of 40 and 60 N
        let behind = [
            (0.3, 0.2, 0.0, true),
            (0.3, -0.2, 0.0, true),
            (0.0, 0.2, 40.0, false),
            (0.0, -0.2, 60.0, false),
        ];
        for (found, expected) in family(&behind)
            .members()
            .iter()
            .zip(family(&FRONT).members())
        {
            assert_eq!(found.sinkages, expected.sinkages);
        }
    }

    #[test]
    fn free_wheels_take_their_resistance_from_the_pull() {
        let (none, one, two) = (family(&FRONT), with_free(&[20.0]), with_free(&[20.0, 20.0]));
        for index in 0..LEVELS {
            let [none, one, two] = [&none, &one, &two].map(|family| family.members()[index]);
            // N: the powered wheels' pull less that of all wheels
            let resistance = |of: &SoilMember, load: f64, slip: usize| {
                100.0 * none.pulls[slip] - load * of.pulls[slip]
            };
            let first = resistance(&one, 120.0, 0);
            assert!(first > 0.0, "{first} N");
            for slip in 0..SLIP_POINTS {
                assert!((resistance(&one, 120.0, slip) - first).abs() < 1e-9);
                assert!((resistance(&two, 140.0, slip) - 2.0 * first).abs() < 1e-9);
            }
            assert_eq!((one.torques, one.sinkages), (none.torques, none.sinkages));
        }
        // a wheel that carries nothing is no wheel of the model
        for load in [0.0, MIN_LOAD_N] {
            assert_eq!(
                with_free(&[load]).members()[0].pulls,
                none.members()[0].pulls
            );
        }
        let known = none.known().expect("the known soil");
        assert_eq!((known.strength, known.stiffness), (1.0, 1.0));
    }

    /// A member whose pull is `at_rest` and rises by `rise` for each unit of slip.
    fn linear(at_rest: f64, rise: f64) -> SoilMember {
        SoilMember {
            strength: 1.0,
            stiffness: 1.0,
            pulls: core::array::from_fn(|index| at_rest + rise * slip_at(index)),
            torques: [0.0; SLIP_POINTS],
            sinkages: [0.0; SLIP_POINTS],
        }
    }

    #[test]
    fn a_pull_has_the_slip_of_its_line() {
        let member = linear(-0.1, 0.5);
        for slip in [MIN_SLIP, 0.0, 0.123, 0.5, 0.999, 1.0] {
            let pull = -0.1 + 0.5 * slip;
            let (found, rise) = member.slip_of_pull(pull).expect("a slip");
            assert!((found - slip).abs() < 1e-9, "{slip}: {found}");
            assert!((rise - 0.5).abs() < 1e-9);
            let (value, rise) = value_at(&member.pulls, slip);
            assert!((value - pull).abs() < 1e-9 && (rise - 0.5).abs() < 1e-9);
        }
        // less pull than the least has the least slip, more than the greatest has none
        let (least, rise) = member.slip_of_pull(-9.0).expect("a slip");
        assert!((least - MIN_SLIP).abs() < 1e-9 && (rise - 0.5).abs() < 1e-9);
        assert_eq!(member.slip_of_pull(0.41), None);
        assert!((member.max_pull() - 0.4).abs() < 1e-9);
        // the greatest pull itself, where more slip gives less, has the least slip too
        let falling = linear(0.3, -0.2);
        let most = falling.max_pull();
        assert!((most - (0.3 - 0.2 * MIN_SLIP)).abs() < 1e-9);
        let (found, rise) = falling.slip_of_pull(most).expect("a slip");
        assert!((found - MIN_SLIP).abs() < 1e-9 && (rise + 0.2).abs() < 1e-9);
        // a table ends at its ends
        for (slip, end) in [(7.0, 0.4), (-7.0, -0.3)] {
            assert!((value_at(&member.pulls, slip).0 - end).abs() < 1e-9);
        }
    }

    #[test]
    fn a_free_wheel_that_the_soil_does_not_turn_slides() {
        let wheel = Wheel::free("free").radius(0.1);
        let rigid = wheel.rigid(0.05).expect("a wheel");
        let sand = grouser_terra::catalogue::find("dry-sand").expect("a soil");
        let sand = sand.soil().expect("a soil");
        let contact = WheelOnSoil::new(rigid, sand, LawSettings::default()).expect("a contact");
        let locked = Kinematics::straight(Slip::new(-1.0).expect("a slip"));
        let found = contact.under_load(20.0, &locked).expect("a load");
        let resistance = -found.point().expect("a sinkage").forces.drawbar_pull;
        let sliding = free_resistance((rigid, 20.0, 1e3), &sand).expect("a resistance");
        let rolling = free_resistance((rigid, 20.0, 0.0), &sand).expect("a resistance");
        assert_eq!(sliding, resistance);
        assert!(0.0 < rolling && rolling < sliding, "{rolling}, {sliding} N");
    }
}

//! A wheel on its soil with derivatives in every parameter, the solved sinkage's among them.
//!
//! The sinkage under a load is found in plain numbers. Its derivatives follow from W(θ_1, p) = load(p):
//! dθ_1 = (d load − ∂W/∂p dp)/(∂W/∂θ_1), one evaluation of the stresses with each kind of dual number. A slip
//! or a slope that solves an equation gets its derivatives in the same way.

use grouser_real::Real;
use grouser_real::{Dual, Scalar};
use grouser_terra::{
    Cautions, Contact, Forces, Kinematics, ModelError, Settings, Slip, SlopeOutcome, WheelOnSoil,
};

use super::inputs::Inputs;
use super::parameter::Parameter;

/// Why there is no value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum NoValue {
    /// A parameter is beyond what the laws take.
    #[error("{}", in_keys(.0))]
    Law(#[from] grouser_terra::Error),
    /// No sinkage carries the load.
    #[error("no sinkage carries {0} N")]
    NotCarried(f64),
    /// No slip holds the slope.
    #[error("no slip holds a slope of {0} deg")]
    NotHeld(f64),
    /// The quantity does not exist here.
    #[error("{0}")]
    Undefined(&'static str),
}

/// What the laws refuse, in the names and units of problem files.
fn in_keys(error: &grouser_terra::Error) -> String {
    let grouser_terra::Error::OutOfRange(range) = error else {
        return error.to_string();
    };
    grouser_files::of_key(range).map_or_else(|| error.to_string(), |range| format!("{range:#}"))
}

/// Forces at one slip.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<R> {
    pub(crate) theta_1: R,
    pub(super) theta_m: R,
    pub(super) slip: R,
    pub(crate) radius: R,
    pub(crate) forces: Forces<R>,
}

impl<R: Scalar> Point<R> {
    /// q = v/(r ω).
    pub(crate) fn speed_ratio(&self) -> R {
        if self.slip.value() >= 0.0 {
            R::ONE - self.slip
        } else {
            R::ONE / (R::ONE + self.slip)
        }
    }
}

fn contact<R: Scalar>(inputs: &Inputs<R>, slip: R, theta_1: R) -> Contact<R> {
    Contact::new(
        &inputs.size(),
        &inputs.laws(),
        inputs.shear_law(),
        &Inputs::motion(slip),
        theta_1,
    )
}

impl Inputs<f64> {
    /// What to keep in mind about the point of the state; nothing where no point is described or solved.
    pub(crate) fn cautions(&self) -> Cautions {
        let point = || -> Result<_, NoValue> {
            let motion = Kinematics::straight(Slip::new(self.get(Parameter::Slip))?);
            let on_soil = self.wheel_on_soil()?;
            Ok(if self.has(Parameter::Load) {
                on_soil.under_load(self.carried(), &motion)?.point()
            } else {
                Some(on_soil.at_sinkage(self.get(Parameter::Sinkage), &motion)?)
            })
        };
        match point() {
            Ok(Some(point)) => point.cautions,
            Ok(None) | Err(_) => Cautions::default(),
        }
    }

    /// What the laws miss of measured wheels in the motion of the state, or at the maximum slip of a search; the outer `None` where
    /// there is no wheel on a soil, the inner one where its laws were not compared.
    #[allow(
        clippy::option_option,
        reason = "a wheel that is not there, or a number that is not known"
    )]
    pub(crate) fn model_error(&self) -> Option<Option<ModelError>> {
        let on_soil = self.wheel_on_soil().ok()?;
        let slip = if self.has(Parameter::Slip) {
            self.get(Parameter::Slip)
        } else {
            on_soil.settings().max_slip
        };
        Some(on_soil.model_error(&Kinematics::straight(Slip::new(slip).ok()?)))
    }

    pub(super) fn wheel_on_soil(&self) -> Result<WheelOnSoil, NoValue> {
        Ok(WheelOnSoil::new(
            self.wheel()?,
            self.soil()?,
            Settings::default(),
        )?)
    }
}

impl<R: Scalar> Inputs<R> {
    /// The load that is carried: W cos α.
    fn carried(&self) -> R {
        self.get(Parameter::Load) * self.radians(Parameter::Slope).cos()
    }

    /// The point of the state: its slip, and its load or its sinkage.
    pub(super) fn point(&self) -> Result<Point<R>, NoValue> {
        let slip = self.get(Parameter::Slip);
        if self.has(Parameter::Load) {
            self.loaded(slip, self.carried())
        } else {
            // The checks of a plain evaluation, then the same with derivatives.
            let plain = self.plain();
            let kinematics = Kinematics::straight(Slip::new(slip.value())?);
            plain
                .wheel_on_soil()?
                .forces_at(plain.get(Parameter::Sinkage), &kinematics)?;
            let sinkage = self.get(Parameter::Sinkage);
            let theta_1 = self
                .laws()
                .entry_at(sinkage, &Self::motion(slip), &self.size());
            Ok(self.at(slip, theta_1))
        }
    }

    fn at(&self, slip: R, theta_1: R) -> Point<R> {
        let contact = contact(self, slip, theta_1);
        Point {
            theta_1,
            theta_m: contact.angles().theta_m,
            slip,
            radius: self.radius(),
            forces: contact.forces(),
        }
    }

    /// The point at `slip` under `load`.
    pub(super) fn loaded(&self, slip: R, load: R) -> Result<Point<R>, NoValue> {
        self.loaded_on(&self.plain().wheel_on_soil()?, slip, load)
    }

    /// The same for the wheel on soil that these inputs describe, made once for many points.
    pub(crate) fn loaded_on(
        &self,
        wheel_on_soil: &WheelOnSoil,
        slip: R,
        load: R,
    ) -> Result<Point<R>, NoValue> {
        let plain = self.plain();
        let kinematics = Kinematics::straight(Slip::new(slip.value())?);
        let solution = wheel_on_soil.sinkage_under(load.value(), &kinematics)?;
        let Some(solved) = solution.outcome.solved() else {
            return Err(NoValue::NotCarried(load.value()));
        };
        let root = solved.theta_1;
        if root == 0.0 {
            return Ok(self.at(slip, R::ZERO));
        }
        let off = contact(self, slip, R::from_f64(root))
            .forces()
            .vertical_force
            - load;
        let single = plain.lifted::<Dual<1>>();
        let rising = contact(
            &single,
            Dual::constant(slip.value()),
            Dual::variable(root, 0),
        )
        .forces()
        .vertical_force
        .gradient[0];
        Ok(self.at(slip, R::from_f64(root) - off / R::from_f64(rising)))
    }

    /// The smallest slip that holds the slope.
    pub(super) fn slip_demand(&self) -> Result<R, NoValue> {
        let plain = self.plain();
        let slope = plain.get(Parameter::Slope);
        let outcome = plain.wheel_on_soil()?.slip_demand(
            plain.get(Parameter::Load),
            grouser_terra::Angle::from_deg(slope),
        )?;
        let SlopeOutcome::Holds { slip } = outcome else {
            return Err(NoValue::NotHeld(slope));
        };
        let slip = slip.value();
        let required = self.get(Parameter::Load) * self.radians(Parameter::Slope).sin();
        let off = self
            .loaded(R::from_f64(slip), self.carried())?
            .forces
            .drawbar_pull
            - required;
        let single = plain.lifted::<Dual<1>>();
        let rising = single
            .loaded(Dual::variable(slip, 0), single.carried())?
            .forces
            .drawbar_pull
            .gradient[0];
        if rising == 0.0 {
            return Err(NoValue::Undefined(
                "the pull does not change with slip here",
            ));
        }
        Ok(R::from_f64(slip) - off / R::from_f64(rising))
    }

    /// The greatest pull over slip, under the load of the state. At the best slip the pull is flat, so that
    /// its derivatives are those at that slip held fixed.
    pub(super) fn greatest_pull(&self) -> Result<R, NoValue> {
        let load = self.carried();
        match self
            .plain()
            .wheel_on_soil()?
            .slip_of_maximum_pull(load.value())?
        {
            Some(best) => {
                let slip = R::from_f64(best.slip.value());
                Ok(self.loaded(slip, load)?.forces.drawbar_pull)
            }
            None => Err(NoValue::NotCarried(load.value())),
        }
    }

    /// The greatest tractive efficiency over slip, likewise.
    pub(super) fn greatest_efficiency(&self) -> Result<R, NoValue> {
        let load = self.carried();
        match self
            .plain()
            .wheel_on_soil()?
            .slip_of_maximum_efficiency(load.value())?
        {
            Some(best) => efficiency(&self.loaded(R::from_f64(best.slip.value()), load)?),
            None => Err(NoValue::Undefined("the wheel pulls at no slip")),
        }
    }

    /// The steepest slope that the wheel holds at any slip, degrees.
    pub(super) fn greatest_slope(&self) -> Result<R, NoValue> {
        let weight = self.get(Parameter::Load);
        let wheel_on_soil = self.plain().wheel_on_soil()?;
        let Some(steepest) = wheel_on_soil.steepest_slope(weight.value())? else {
            return Err(NoValue::Undefined(
                "the wheel cannot pull itself on the level",
            ));
        };
        if R::IS_PLAIN {
            return Ok(R::from_f64(steepest.slope.deg()));
        }
        let (alpha, slip) = (steepest.slope.rad(), steepest.slip.value());
        // DP(W cos α) − W sin α = 0 at the best slip; by its parameters, and by α.
        let (sin, cos) = Real::sin_cos(alpha);
        let here = self.loaded(R::from_f64(slip), weight * R::from_f64(cos))?;
        let off = here.forces.drawbar_pull - weight * R::from_f64(sin);
        let single = self.plain().lifted::<Dual<1>>();
        let turned = Dual::<1>::variable(alpha, 0);
        let (turned_sin, turned_cos) = grouser_real::Real::sin_cos(turned);
        let single_weight = single.get(Parameter::Load);
        let there = single.loaded(Dual::constant(slip), single_weight * turned_cos)?;
        let falling = (there.forces.drawbar_pull - single_weight * turned_sin).gradient[0];
        let solved = R::from_f64(alpha) - off / R::from_f64(falling);
        Ok(solved * R::from_f64(180.0 / std::f64::consts::PI))
    }
}

/// η = DP q r/T; negative where the wheel resists.
pub(super) fn efficiency<R: Scalar>(point: &Point<R>) -> Result<R, NoValue> {
    if !(point.forces.torque.value() > 0.0) {
        return Err(NoValue::Undefined("the wheel is not driven"));
    }
    Ok(point.forces.drawbar_pull * point.speed_ratio() * point.radius / point.forces.torque)
}

//! The laws of a soil and the sizes of a wheel that drives straight ahead, as operations on a tape.

use grouser_opt::{Binary, Node, Unary};
use grouser_terra::DrivingSlip;

use super::Parameter;
use super::taped::Taped;

impl Taped<'_> {
    /// The slip velocity along a wheel that drives straight ahead: (rω − v) over the greater speed or over their root.
    pub(super) fn slip_velocity(&mut self, slip: Node, q: Node) -> Node {
        if !self.fixed.laws().slip_norm.driving().over_root {
            return slip;
        }
        let one = self.tape.constant(1.0);
        let square = self.tape.whole_power(q, 2);
        let sum = self.add(one, square);
        let speed = self.tape.unary(Unary::Sqrt, sum);
        self.div(slip, speed)
    }

    /// What a law takes of the slip and the slip velocity.
    fn taken(&mut self, driving: DrivingSlip, slip: Node, velocity: Node) -> Node {
        let x = if driving.over_root { velocity } else { slip };
        if !driving.levels_off {
            return x;
        }
        let (one, half) = (self.tape.constant(1.0), self.times(0.5, x));
        let rest = self.sub(one, half);
        self.mul(x, rest)
    }

    /// n(s).
    pub(super) fn exponent(&mut self, slip: Node, velocity: Node) -> Option<Node> {
        let (n_0, n_1) = (
            self.get(Parameter::Exponent)?,
            self.get(Parameter::ExponentDriving)?,
        );
        if self.fixed.get(Parameter::ExponentDriving) == Some(0.0) {
            return Some(n_0);
        }
        let laws = self.fixed.laws();
        let taken = self.taken(laws.slip_sinkage.driving(laws.slip_norm), slip, velocity);
        let rate = if laws.slip_sinkage.is_signed() {
            n_1
        } else {
            self.tape.unary(Unary::Abs, n_1)
        };
        let growth = self.mul(rate, taken);
        Some(self.add(n_0, growth))
    }

    /// θ_m/θ_1 in [0, 1].
    pub(super) fn position(&mut self, slip: Node, velocity: Node) -> Option<Node> {
        let laws = self.fixed.laws();
        let driving = laws.stress_position.driving(laws.slip_norm);
        let moved_by = self.taken(driving, slip, velocity);
        let (c_1, c_2) = (self.get(Parameter::C1)?, self.get(Parameter::C2)?);
        let growth = self.mul(c_2, moved_by);
        let sum = self.add(c_1, growth);
        let (one, zero) = (self.tape.constant(1.0), self.tape.constant(0.0));
        let above = self.tape.binary(Binary::Max, sum, zero);
        Some(self.tape.binary(Binary::Min, above, one))
    }

    /// θ_2/θ_1 = −2 arcsin(f √λ sin(θ_1/2))/θ_1 with the share f that slip leaves of the rear; `None` without rebound.
    pub(super) fn exit(&mut self, theta_1: Node, velocity: Node) -> Option<Node> {
        if self.fixed.get(Parameter::Rebound) == Some(0.0) {
            return None;
        }
        let rebound = self.get(Parameter::Rebound)?;
        let (one, zero) = (self.tape.constant(1.0), self.tape.constant(0.0));
        let mut root = self.tape.unary(Unary::Sqrt, rebound);
        let driving = self.fixed.rear_driving();
        if driving != 0.0 {
            let lost = self.times(driving, velocity);
            let share = self.sub(one, lost);
            let share = self.tape.binary(Binary::Max, share, zero);
            root = self.mul(root, share);
        }
        // with a = arcsin(f √λ sin(θ_1/2)) this is −f √λ sinc(θ_1/2)/sinc a, in which nothing cancels over a wide box
        let half = self.times(0.5, theta_1);
        let sine = self.tape.unary(Unary::Sin, half);
        let sine = self.mul(root, sine);
        let angle = self.tape.unary(Unary::Asin, sine);
        let (outer, inner) = (
            self.tape.unary(Unary::Sinc, half),
            self.tape.unary(Unary::Sinc, angle),
        );
        let ratio = self.div(outer, inner);
        let share = self.mul(root, ratio);
        Some(self.tape.unary(Unary::Neg, share))
    }

    /// The depth to which soil is carried away, δ s/(1 − s); `None` where none is.
    pub(super) fn carried_away(&mut self, radius: Node, (slip, q): (Node, Node)) -> Option<Node> {
        let soil_layer = self.fixed.transport_layer();
        let lugs = self.lugs();
        if soil_layer == 0.0 && lugs.is_none() {
            return None;
        }
        let mut layer = self.tape.constant(soil_layer);
        if let Some((height, count)) = lugs {
            let thickness = self.get(Parameter::GrouserThickness)?;
            let around = self.times(std::f64::consts::TAU, radius);
            let taken = self.mul(count, thickness);
            let taken = self.div(taken, around);
            let one = self.tape.constant(1.0);
            let free = self.sub(one, taken);
            let carried = self.mul(height, free);
            let carried = self.times(0.5, carried);
            layer = self.add(layer, carried);
        }
        let ratio = self.div(slip, q);
        Some(self.mul(layer, ratio))
    }

    /// A = k rⁿ, with the tips' share where only a part of the stress acts there.
    pub(super) fn amplitude(&mut self, radius: Node, n: Node) -> Option<Node> {
        let modulus = self.modulus_at(n)?;
        let mut reach = self.tape.binary(Binary::Power, radius, n);
        if let Some(tips) = self.fixed.tip_share() {
            let rim = self.get(Parameter::Radius)?;
            let bare = self.tape.binary(Binary::Power, rim, n);
            let (at_tips, at_rim) = (self.times(tips, reach), self.times(1.0 - tips, bare));
            reach = self.add(at_tips, at_rim);
        }
        Some(self.mul(modulus, reach))
    }

    /// 1 + 1.75 N h/(2π r), by which lugs multiply the shear displacement; `None` without lugs.
    pub(super) fn lug_mobilisation(&mut self, radius: Node) -> Option<Node> {
        let (height, count) = self.lugs()?;
        let one = self.tape.constant(1.0);
        let faces = self.mul(count, height);
        let around = self.times(std::f64::consts::TAU, radius);
        let ratio = self.div(faces, around);
        // the law's own number, of a ratio of 1
        let gain = self.times(
            grouser_terra::lug_mobilisation(std::f64::consts::TAU, 1.0, 1.0),
            ratio,
        );
        Some(self.add(one, gain))
    }

    /// The radius of the shear displacement: at bars that bear a share of the stress only, the soil shears as at the rim.
    pub(super) fn shear_radius(&self, radius: Node) -> Option<Node> {
        match self.fixed.tip_share() {
            Some(_) => self.get(Parameter::Radius),
            None => Some(radius),
        }
    }

    /// z = 2 r sin²(θ_1/2).
    pub(super) fn depth_of(&mut self, theta_1: Node, radius: Node) -> Node {
        let half = self.times(0.5, theta_1);
        let sine = self.tape.unary(Unary::Sin, half);
        let square = self.tape.whole_power(sine, 2);
        let diameter = self.times(2.0, radius);
        self.mul(diameter, square)
    }
}

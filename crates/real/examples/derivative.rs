//! Newton's method with exact derivatives: the sinkage at which Bekker's pressure carries a load.
//! `cargo run -p grouser-real --example derivative`

use std::io::Write as _;

use grouser_real::{Dual, Real};

/// Bekker's pressure in Pa at a depth z in m, for a plate on dry sand: k zⁿ.
fn pressure<R: Real>(z: R) -> R {
    R::from_f64(1.5e6) * (R::from_f64(1.1) * z.ln()).exp()
}

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let (mut z, load) = (0.05, 20e3); // m, Pa
    for _ in 0..6 {
        let p = pressure(Dual::<1>::variable(z, 0));
        writeln!(
            out,
            "z = {z:.9} m, p = {:.3} Pa, dp/dz = {:.6e} Pa/m",
            p.value, p.gradient[0]
        )?;
        z -= (p.value - load) / p.gradient[0];
    }
    let exact = (load / 1.5e6_f64).powf(1.0 / 1.1);
    writeln!(out, "closed form {exact:.9} m")
}

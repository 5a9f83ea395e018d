use grouser_identify::validate::validate;
fn main() {
    let v = validate(std::path::Path::new("/work/shared/data")).unwrap();
    for r in &v.rows {
        println!(
            "{:9} {:7} {:4} {:10} {:10} {:22} {:8} p{} n{} bias {:6.2} rmse {:6.2} q75 {:.2} max {:.2} pub {:?} sc {:?} hub {}",
            r.data_set,
            r.wheel,
            r.slip_angle_deg,
            r.quantity.key(),
            r.model.key(),
            r.fit,
            r.split.key(),
            r.fitted_parameters,
            r.score.n,
            r.score.bias,
            r.score.rmse,
            r.score.q75,
            r.score.max,
            r.published_rmse,
            r.scatter,
            r.hub_buried
        );
    }
    for f in &v.fits {
        println!(
            "{} {} {} {:?} cond {:.0}",
            f.data_set,
            f.model.key(),
            f.fit,
            f.status,
            f.condition
        );
        for p in &f.found {
            println!(
                "   {:22} {:9.4} ± {:.4} {}",
                p.parameter.key(),
                p.parameter.to_key_unit(p.value),
                p.parameter.to_key_unit(p.standard_error),
                p.verdict.key()
            );
        }
    }
}

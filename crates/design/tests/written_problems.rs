//! Problems that are written and read again.

use grouser_design::{Design, DesignBuilder, Error, ObjectiveParams, State, Task, parse, to_toml};
use grouser_files::Document;
use grouser_opt::{Algorithm, Measure, ParetoSettings, Settings, Variable};
use grouser_terra::{LawChoice, RigidWheel, ShearLaw, Soil, SoilParams, catalogue};
use proptest::prelude::*;

fn soil(key: &str) -> Soil {
    catalogue::find(key).unwrap().soil().unwrap()
}

/// Read again, a problem is the same, and its functions have the same bits at `x`.
fn check(builder: &DesignBuilder, x: &[f64]) {
    let text = to_toml(builder).unwrap();
    let document = Document::from_text("written.toml", text.clone()).unwrap();
    let again = parse(&document).unwrap();
    let own = builder.clone().build().unwrap();
    assert_eq!((&again.title, again.task), (&own.title, own.task), "{text}");
    assert_eq!(again.variables, own.variables, "{text}");
    assert_eq!(again.objectives, own.objectives, "{text}");
    assert_eq!((again.starts, again.seed), (own.starts, own.seed), "{text}");
    assert_eq!(
        (&again.settings, &again.pareto),
        (&own.settings, &own.pareto),
        "{text}"
    );
    assert_eq!(again.fixed(), own.fixed(), "{text}");
    if own.task != Task::Pareto {
        let (a, b) = (again.merit(x).unwrap(), own.merit(x).unwrap());
        assert_eq!(a.utility.to_bits(), b.utility.to_bits(), "{text}");
        assert_eq!(a.violation.to_bits(), b.violation.to_bits(), "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_problem_read_again_is_the_same(
        key in prop::sample::select(vec!["dry-sand", "lunar", "sandy-loam"]),
        (radius, width, load) in (0.05..0.4_f64, 0.03..0.3_f64, 5.0..200.0_f64),
        (start, lower, upper) in (0.1..0.5_f64, 0.0..0.1_f64, 0.5..0.9_f64),
        (scale, goal, weight) in (1e-6..1e6_f64, -1e3..1e3_f64, 0.01..10.0_f64),
        (maximise, absolute) in prop::sample::select(vec![(false, false), (true, false), (false, true)]),
        task in prop::sample::select(Task::ALL.map(|(_, task)| task).to_vec()),
        (name, title) in ("[a-z \"\\\\é]{1,12}", "[ -~]{0,20}"),
        (starts, seed) in (1_usize..100, 0_u64..1 << 60),
        (tolerance, iterations) in (1e-12..1e-3_f64, 1_usize..10_000),
        (population, divisions, polish) in (4_usize..1000, prop::option::of(1_usize..100), any::<bool>()),
        algorithm in prop::sample::select(vec![None, Some(Algorithm::NsgaII), Some(Algorithm::NsgaIII)]),
        at in 0.1..0.5_f64,
    ) {
        let mut objective = ObjectiveParams::new(name.clone(), "drawbar_pull_n - 2*sinkage_m");
        (objective.scale, objective.goal, objective.weight) = (scale, Some(goal), weight);
        (objective.maximise, objective.absolute) = (maximise, absolute);
        let mut settings = Settings::default();
        (settings.step_tolerance, settings.max_iterations) = (tolerance, iterations);
        let mut pareto = ParetoSettings::default();
        (pareto.population, pareto.divisions, pareto.polish) = (population, divisions, polish);
        pareto.algorithm = algorithm;
        let wheel = RigidWheel::new(radius, width).unwrap();
        let builder = Design::builder(&wheel, &soil(key), State::under_load(load))
            .title(title)
            .task(task)
            .variable(Variable::bounded("slip", start, lower, upper))
            .variable(Variable::free("x1", -start))
            .objective(objective)
            .constraint(format!("{name} too"), "slip + x1 <= 1")
            .constraint("round", "x1^2 >= 1e-8")
            .starts(starts, seed)
            .settings(settings)
            .pareto(pareto);
        check(&builder, &[at, -at]);
    }
}

#[test]
fn what_a_file_does_not_hold_is_refused() {
    let wheel = RigidWheel::new(0.125, 0.1).unwrap();
    let on = |soil: &Soil| {
        Design::builder(&wheel, soil, State::under_load(60.0))
            .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
            .minimise("pull", "-drawbar_pull_n")
    };
    let sand = soil("dry-sand");
    assert!(to_toml(&on(&sand)).is_ok());
    let worlds = on(&sand).worlds(Measure::WorstCase, &[("a", sand), ("b", soil("lunar"))]);
    let laws = LawChoice {
        shear: Some(ShearLaw::SlipVelocity),
        ..LawChoice::default()
    };
    let lawful = Soil::new(SoilParams {
        laws,
        ..*sand.params()
    });
    let mut probes = Settings::default();
    probes.probes = 0;
    let nan = Variable::bounded("slip", f64::NAN, 0.01, 0.8);
    for (builder, what) in [
        (worlds, "several soils"),
        (on(&lawful.unwrap()), "laws"),
        (on(&sand).settings(probes), "probes"),
    ] {
        let error = to_toml(&builder).unwrap_err();
        assert!(matches!(error, Error::Contradiction { .. }), "{error}");
        assert!(error.to_string().contains(what), "{error}");
    }
    assert!(to_toml(&on(&sand).variable(nan)).is_err());
}

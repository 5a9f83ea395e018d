//! Jobs in turn, round after round, so that a busy machine slows them all alike.

use std::time::Instant;

/// A job: its name, and what it gives, which all of them must give alike.
pub struct Job<'a> {
    pub name: &'static str,
    pub run: Box<dyn FnMut() -> u64 + 'a>,
}

/// The median time of each job, s.
pub fn medians(jobs: &mut [Job<'_>], rounds: usize) -> Vec<f64> {
    let mut times = vec![Vec::new(); jobs.len()];
    let mut first = None;
    for _ in 0..rounds {
        for (job, times) in jobs.iter_mut().zip(&mut times) {
            let start = Instant::now();
            let sum = (job.run)();
            times.push(start.elapsed().as_secs_f64());
            let expected = *first.get_or_insert(sum);
            assert_eq!(sum, expected, "`{}` gives something else", job.name);
        }
    }
    for times in &mut times {
        times.sort_by(f64::total_cmp);
    }
    times.iter().map(|times| times[times.len() / 2]).collect()
}

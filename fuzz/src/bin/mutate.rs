//! `mutate TARGET [EXECUTIONS [SEED]]`: a target over its committed seeds, mutated at random; the same seed gives the same cases.
//! `mutate list` names the targets.
//! Without libFuzzer and its feedback, on any Rust: what CI runs of a target.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use mutatis::Session;

/// Longest time of one case: a minute of a robot's samples takes milliseconds.
const LONGEST: Duration = Duration::from_secs(5);
/// After this time a case is taken for one without end, on a machine however busy.
const ENDLESS: Duration = Duration::from_secs(60);
const MAX_BYTES: usize = 16 << 10;
/// Peak memory of the whole process, kB.
const MAX_MEMORY_KB: u64 = 512 << 10;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = arguments.first().map_or("", String::as_str);
    let number = |at: usize, default: u64| match arguments.get(at) {
        Some(text) => text.parse().ok(),
        None => Some(default),
    };
    if name == "list" {
        for target in grouser_fuzz::TARGETS {
            println!("{}", target.name);
        }
        return ExitCode::SUCCESS;
    }
    let (Some(target), Some(executions), Some(seed)) = (
        grouser_fuzz::find(name),
        number(1, 100_000),
        number(2, 2012),
    ) else {
        eprintln!("mutate list | TARGET [EXECUTIONS [SEED]]");
        return ExitCode::from(2);
    };
    let seeds = seeds(name);
    let mut session = Session::new().seed(seed);
    let mut random = seed;
    let began = Instant::now();
    let mut longest = Duration::ZERO;
    let running = Arc::new(Mutex::new(None));
    end_endless(name.to_owned(), seed, Arc::clone(&running));
    for execution in 0..executions {
        let case = case(&seeds, &mut session, &mut random);
        let start = Instant::now();
        *running.lock().expect("a lock") = Some((execution, case.clone(), start));
        let ended = std::panic::catch_unwind(|| (target.run)(&case));
        let took = start.elapsed();
        longest = longest.max(took);
        if ended.is_err() || took > LONGEST {
            let path = keep(name, execution, &case);
            eprintln!(
                "{name}: case {execution} of seed {seed} took {took:?}, kept in {}",
                path.display()
            );
            return ExitCode::FAILURE;
        }
    }
    let memory = peak_memory_kb();
    println!(
        "{name}: {executions} cases from {} seeds in {:.1} s, the longest {:.0} ms, at most {} MB of memory",
        seeds.len(),
        began.elapsed().as_secs_f64(),
        1e3 * longest.as_secs_f64(),
        memory >> 10,
    );
    if memory > MAX_MEMORY_KB {
        eprintln!("{name}: {memory} kB of memory, more than {MAX_MEMORY_KB}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

/// A case under way: its number, its bytes and when it began.
type Running = Arc<Mutex<Option<(u64, Vec<u8>, Instant)>>>;

/// Ends the process, and keeps the case, where a case takes longer than [`ENDLESS`].
fn end_endless(name: String, seed: u64, running: Running) {
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_secs(1));
            if let Some((execution, case, start)) = running.lock().expect("a lock").as_ref()
                && start.elapsed() > ENDLESS
            {
                let path = keep(&name, *execution, case);
                eprintln!(
                    "{name}: case {execution} of seed {seed} does not end, kept in {}",
                    path.display()
                );
                std::process::exit(1);
            }
        }
    });
}

/// Folders of seeds beside a target's own, as in `fuzz/run`.
fn other_folders(name: &str) -> &'static [&'static str] {
    match name {
        "mcap_read" | "bag_read" | "database_read" | "recover" => &["crates/log/tests/interop"],
        "toml_config" => &["examples/scenarios", "examples/robots", "examples/problems"],
        "urdf" => &["examples/robots"],
        _ => &[],
    }
}

/// The committed seeds, and files of the project.
fn seeds(name: &str) -> Vec<Vec<u8>> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![here.join("seeds").join(name)];
    folders.extend(
        other_folders(name)
            .iter()
            .map(|folder| here.join("..").join(folder)),
    );
    let mut files: Vec<PathBuf> = folders
        .iter()
        .filter_map(|folder| fs::read_dir(folder).ok())
        .flat_map(|entries| entries.flatten().map(|entry| entry.path()))
        .filter(|path| path.is_file())
        .collect();
    files.sort();
    let mut seeds: Vec<Vec<u8>> = files
        .iter()
        .filter_map(|path| fs::read(path).ok())
        .collect();
    if seeds.is_empty() {
        seeds.push(vec![0; 64]);
    }
    seeds
}

/// A seed, or the head of one and the tail of another, with up to eight mutations.
fn case(seeds: &[Vec<u8>], session: &mut Session, random: &mut u64) -> Vec<u8> {
    let mut draw = |below: usize| {
        // splitmix64
        *random = random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *random;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % below.max(1) as u64) as usize
    };
    let mut case = seeds[draw(seeds.len())].clone();
    if draw(4) == 0 {
        let other = &seeds[draw(seeds.len())];
        case.truncate(draw(case.len() + 1));
        case.extend_from_slice(&other[draw(other.len() + 1)..]);
    }
    case.truncate(MAX_BYTES);
    for _ in 0..=draw(8) {
        let _ = session.mutate(&mut case);
    }
    case
}

fn keep(name: &str, execution: u64, case: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("artifacts")
        .join(name);
    let path = folder.join(format!("case-{execution}"));
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(&path, case).expect("a file");
    path
}

/// Zero where the system does not tell.
fn peak_memory_kb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|rest| rest.split_whitespace().next()?.parse().ok())
        .unwrap_or(0)
}

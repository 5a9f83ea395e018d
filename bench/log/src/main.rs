//! Reading MCAP beside the mcap crate's streaming readers, on one file in one run; decoding; memory.
//!
//! `write FILE MIB` writes a log by the mcap crate, `read FILE` compares the readers, `decode` times one message,
//! `decoders` compares decoders of zstd, `memory FILE` reads with ours alone and prints the most memory.

mod readers;
mod written;

use std::path::Path;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["write", file, mib] => written::write(Path::new(file), mib.parse().expect("MiB")),
        ["read", file] => read(Path::new(file)),
        ["decode"] => decode(),
        ["decoders"] => decoders(),
        ["memory", file] => {
            let begin = Instant::now();
            let found = readers::ours(Path::new(file));
            let took = begin.elapsed().as_secs_f64();
            println!("{found:?}, {took:.2} s, at most {} MiB of memory", most_memory());
        }
        _ => {
            eprintln!("usage: write FILE MIB | read FILE | decode | decoders | memory FILE");
            std::process::exit(2);
        }
    }
}

/// The most memory that this process has held, MiB.
fn most_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kib.unwrap_or(0) / 1024
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Every reader in turn, so that none has the warmer machine.
fn read(file: &Path) {
    const ROUNDS: usize = 11;
    let jobs: [(&str, fn(&Path) -> readers::Found); 4] = [
        ("ours: CRCs checked, damage found, no index", readers::ours),
        ("mcap io::MessageReader", readers::messages),
        ("mcap LinearReader", readers::linear),
        ("mcap LinearReader, CRCs checked", readers::linear_checked),
    ];
    let mut times = vec![Vec::new(); jobs.len()];
    let expected = readers::ours(file);
    for _ in 0..ROUNDS {
        for (k, (name, job)) in jobs.iter().enumerate() {
            let begin = Instant::now();
            let found = job(file);
            times[k].push(begin.elapsed().as_secs_f64());
            assert_eq!(found, expected, "{name}");
        }
    }
    let bytes = std::fs::metadata(file).expect("a file").len() as f64;
    println!("{} messages, {} bytes of data, file {bytes} bytes", expected.messages, expected.bytes);
    let first = median(&mut times[0]);
    for (k, (name, _)) in jobs.iter().enumerate() {
        let time = median(&mut times[k]);
        let rate = expected.bytes as f64 / time / 1e6;
        println!("{name}: {:.1} ms, {rate:.0} MB/s of data; ours at {:.2} of its speed", time * 1e3, time / first);
    }
}

fn decode() {
    let (channel, data) = written::joint_state();
    let decoder = grouser_log::message::Decoder::new(&channel).expect("a decoder");
    let mut times = Vec::new();
    let mut view_times = Vec::new();
    for _ in 0..51 {
        const COUNT: u32 = 2000;
        let begin = Instant::now();
        for _ in 0..COUNT {
            std::hint::black_box(decoder.decode(std::hint::black_box(&data)).expect("a value"));
        }
        times.push(begin.elapsed().as_secs_f64() / f64::from(COUNT) * 1e9);
        let value = decoder.decode(&data).expect("a value");
        let begin = Instant::now();
        for _ in 0..COUNT {
            std::hint::black_box(grouser_log::message::View::new(
                "sensor_msgs/msg/JointState",
                std::hint::black_box(&value),
            ));
        }
        view_times.push(begin.elapsed().as_secs_f64() / f64::from(COUNT) * 1e9);
    }
    println!(
        "JointState of five joints, {} bytes of CDR: decoded in {:.0} ns, its view in {:.0} ns more",
        data.len(),
        median(&mut times),
        median(&mut view_times)
    );
}

/// Decoders of zstd on one chunk of 768 KiB of such messages.
fn decoders() {
    use std::io::Read;
    let content = written::content(768 << 10);
    let packed = zstd::bulk::compress(&content, 3).expect("packed");
    let mut out = vec![0; content.len()];
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    let mut zrip = zrip_decode::context::DecompressContext::new();
    let mut to = Vec::new();
    for _ in 0..31 {
        let begin = Instant::now();
        zstd::bulk::decompress_to_buffer(&packed, &mut out).expect("content");
        times[0].push(begin.elapsed().as_secs_f64());
        assert!(out == content);
        let begin = Instant::now();
        to.clear();
        zrip.decompress_into_with_limit(&packed, &mut to, content.len()).expect("content");
        times[1].push(begin.elapsed().as_secs_f64());
        assert!(to == content);
        let begin = Instant::now();
        to.clear();
        let mut decoder = ruzstd::decoding::StreamingDecoder::new(&packed[..]).expect("a frame");
        decoder.read_to_end(&mut to).expect("content");
        times[2].push(begin.elapsed().as_secs_f64());
        assert!(to == content);
    }
    println!("{} bytes packed to {}", content.len(), packed.len());
    let c = median(&mut times[0]);
    for (name, times) in ["zstd (C)", "zrip-decode", "ruzstd"].iter().zip(&mut times) {
        let time = median(times);
        println!("{name}: {:.0} MB/s, {:.2} of C", content.len() as f64 / time / 1e6, c / time);
    }
}

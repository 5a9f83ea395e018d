//! Every message of a file: ours, and the streaming reader of the `mcap` crate with and without the checks
//! that ours makes.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use grouser_log::container::{Container, Event};
use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;

use crate::timing::{Job, medians};

const ROUNDS: usize = 15;

/// Of a message: what costs little, and differs where anything is missing or out of order.
fn add(sum: u64, log_time: u64, data: &[u8]) -> u64 {
    let ends = u64::from(data[0]) ^ u64::from(data[data.len() - 1]) << 8;
    sum.rotate_left(1) ^ log_time ^ (data.len() as u64) << 32 ^ ends
}

fn ours(path: &Path) -> u64 {
    let mut container = Container::open(path).expect("a log");
    let mut sum = 0;
    while let Some(event) = container.next() {
        match event {
            Event::Message(message) => sum = add(sum, message.log_time_ns, message.data),
            Event::Damage(damage) => panic!("{damage:?}"),
        }
    }
    sum
}

fn theirs(path: &Path, options: LinearReaderOptions) -> u64 {
    let file = BufReader::new(File::open(path).expect("a file"));
    let mut sum = 0;
    for message in MessageReader::new_with_options(file, options) {
        let message = message.expect("a message");
        sum = add(sum, message.log_time, &message.data);
    }
    sum
}

pub fn run(path: &Path) {
    let bytes = std::fs::metadata(path).expect("a file").len() as f64;
    let checked = || {
        LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
    };
    let mut jobs = [
        Job {
            name: "grouser, all CRCs",
            run: Box::new(|| ours(path)),
        },
        Job {
            name: "mcap crate, its default",
            run: Box::new(|| theirs(path, LinearReaderOptions::default())),
        },
        Job {
            name: "mcap crate, the same CRCs",
            run: Box::new(|| theirs(path, checked())),
        },
    ];
    let times = medians(&mut jobs, ROUNDS);
    println!(
        "\nEvery message of {:.1} MiB, zstd; medians of {ROUNDS} rounds in turn",
        bytes / 1048576.0
    );
    for (job, time) in jobs.iter().zip(&times) {
        let (ms, rate) = (time * 1e3, bytes / time / 1e6);
        let ratio = time / times[0];
        println!(
            "{:28} {ms:8.1} ms {rate:7.0} MB/s   ours is {ratio:.2} times as fast",
            job.name
        );
    }
}

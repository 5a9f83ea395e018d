//! The chunks of a file through each decoder of zstd, in memory.

use std::fs;
use std::hint::black_box;
use std::path::Path;

use crate::timing::{Job, medians};

const ROUNDS: usize = 15;

/// Packed chunks with the sizes that they unfold to: the records of opcode 6.
fn chunks(path: &Path) -> Vec<(Vec<u8>, usize)> {
    let file = fs::read(path).expect("a file");
    let mut at = 8;
    let mut chunks = Vec::new();
    let number =
        |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().expect("8 bytes")) as usize;
    while at + 9 < file.len() {
        let length = number(at + 1);
        if file[at] == 6 {
            let size = number(at + 9 + 16);
            // times, size, CRC, the name `zstd` with its count, the count of bytes
            let start = at + 9 + 28 + 8 + 8;
            chunks.push((file[start..at + 9 + length].to_vec(), size));
        }
        at += 9 + length;
    }
    chunks
}

pub fn run(path: &Path) {
    let chunks = chunks(path);
    let most = chunks.iter().map(|chunk| chunk.1).max().expect("chunks");
    let all: usize = chunks.iter().map(|chunk| chunk.1).sum();
    let each = |mut unpack: Box<dyn FnMut(&[u8], usize) -> u64>| {
        let chunks = &chunks;
        Box::new(move || {
            let sums = chunks.iter().map(|(packed, size)| unpack(packed, *size));
            sums.fold(0_u64, |sum, one| sum.rotate_left(1) ^ one)
        })
    };
    let sum = |out: &[u8]| black_box(out.len() as u64) ^ u64::from(out[out.len() - 1]) << 40;
    let mut zrip = (
        zrip_decode::context::DecompressContext::new(),
        Vec::with_capacity(most + 256),
    );
    let mut ruzstd = (ruzstd::decoding::FrameDecoder::new(), vec![0; most]);
    let mut zstd = (
        zstd::bulk::Decompressor::new().expect("a decoder"),
        vec![0; most],
    );
    let mut jobs = [
        Job {
            name: "zrip-decode (ours)",
            run: each(Box::new(move |packed, size| {
                zrip.1.clear();
                zrip.0
                    .decompress_into_with_limit(packed, &mut zrip.1, size)
                    .expect("a chunk");
                sum(&zrip.1)
            })),
        },
        Job {
            name: "zstd, C through cc",
            run: each(Box::new(move |packed, _| {
                let size = zstd
                    .0
                    .decompress_to_buffer(packed, &mut zstd.1)
                    .expect("a chunk");
                sum(&zstd.1[..size])
            })),
        },
        Job {
            name: "ruzstd",
            run: each(Box::new(move |packed, _| {
                let size = ruzstd.0.decode_all(packed, &mut ruzstd.1).expect("a chunk");
                sum(&ruzstd.1[..size])
            })),
        },
    ];
    let times = medians(&mut jobs, ROUNDS);
    println!(
        "\nIts {} chunks, {:.1} MiB, out of zstd in memory",
        chunks.len(),
        all as f64 / 1048576.0
    );
    for (job, time) in jobs.iter().zip(&times) {
        let (ms, rate) = (time * 1e3, all as f64 / time / 1e6);
        println!(
            "{:28} {ms:8.1} ms {rate:7.0} MB/s   {:.2} of the first",
            job.name,
            times[0] / time
        );
    }
}

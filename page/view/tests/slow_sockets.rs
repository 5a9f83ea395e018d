//! Pages that do not read cost a run nothing. Alone in its file: it measures time.

mod running;

use std::fmt::Write as _;
use std::io::Write as _;
use std::net::TcpStream;
use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use grouser_view::run::RecordedRun;
use running::start_with;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/five-wheel");

/// How long the example's log takes, a hundred times over, with the server's pages reading or not.
fn estimating_time(log: &Path, slow: usize) -> Duration {
    let robot = Path::new(EXAMPLE).join("robot.toml");
    let map = Path::new(EXAMPLE).join("columns.toml");
    let run = RecordedRun::open(log, &robot, Some(&map), false).expect("a log");
    let started = Instant::now();
    let feed = run.start();
    let server = start_with(None, Some(feed.clone()));
    let cookie = server.sign_in();
    let sockets: Vec<TcpStream> = (0..slow)
        .map(|i| {
            let mut stream = server.connect();
            let host = server.host();
            // half never end their head, half request the run and never read it
            let request = if i % 2 == 0 {
                "G".to_owned()
            } else {
                format!("GET /api/run/0 HTTP/1.1\r\nHost: {host}\r\n{cookie}\r\n")
            };
            stream.write_all(request.as_bytes()).expect("sent");
            stream
        })
        .collect();
    let mut next = 0;
    loop {
        let answer = feed.from(next);
        next = answer.next;
        for part in answer.parts {
            let text = String::from_utf8_lossy(&part);
            assert!(!text.contains("\"failed\""), "{text}");
            if text.contains("{\"end\":") {
                drop(sockets);
                return started.elapsed();
            }
        }
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_thousand_slow_sockets_do_not_slow_a_run() {
    let text = std::fs::read_to_string(Path::new(EXAMPLE).join("log.csv")).expect("the example");
    let folder = std::env::temp_dir().join(format!("grouser-view-slow-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let log = folder.join("log.csv");
    let (head, rows) = text.split_once('\n').expect("a header");
    let mut long = format!("{head}\n");
    for lap in 0..100 {
        for row in rows.lines() {
            let (time, rest) = row.split_once(',').expect("columns");
            let time: u64 = time.parse().expect("a time");
            let _ = writeln!(long, "{},{rest}", time + lap * 40_020);
        }
    }
    std::fs::write(&log, long).expect("written");
    // What else the machine does delays a run, now with the sockets and now without them: a server that waits for a slow socket
    // waits for its limit of time, 10 s, in every round. Opening a thousand sockets takes a while next to the run.
    let is_quick = (0..10).any(|_| {
        let (alone, attacked) = (estimating_time(&log, 0), estimating_time(&log, 1000));
        println!("alone {alone:?}, with a thousand slow sockets {attacked:?}");
        attacked < alone * 2 + Duration::from_secs(4)
    });
    let _ = std::fs::remove_dir_all(&folder);
    assert!(is_quick, "a thousand slow sockets slow every run");
}

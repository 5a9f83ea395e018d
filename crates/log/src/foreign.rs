//! Files of other programs, known by their first bytes, with the command that converts them.

use crate::error::{Error, Result};

/// First bytes that are looked at: a tar archive has its mark at 257.
pub(crate) const LOOKED_BYTES: usize = 264;

/// A kind of file: where its mark is, the mark, its name, and what to do.
type Kind = (usize, &'static [u8], &'static str, &'static str);

const TO_CSV: &str = "export it as CSV";
const KINDS: &[Kind] = &[
    (
        0,
        b"ULog\x01\x12\x35",
        "a PX4 ULog file",
        "`pip install pyulog`, then `ulog2csv FILE` makes CSV tables",
    ),
    (
        0,
        b"\xa3\x95\x80\x80",
        "an ArduPilot DataFlash log",
        "`pip install pymavlink`, then `mavlogdump.py --format csv --types WENC,GPS FILE` makes a CSV table",
    ),
    (
        0,
        b"MATLAB 5.0 MAT-file",
        "a MATLAB file",
        "`writetable` of MATLAB, or `scipy.io.loadmat` with `numpy.savetxt`, makes a CSV table",
    ),
    (
        0,
        b"MATLAB 7.3 MAT-file",
        "a MATLAB file (HDF5)",
        "`writetable` of MATLAB makes a CSV table",
    ),
    (
        0,
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file",
        "`h5dump -d DATASET -o OUT.csv -y -w 0 FILE` makes a CSV table of one data set",
    ),
    (
        0,
        b"PAR1\x15",
        "a Parquet file",
        "`python -c \"import pandas; pandas.read_parquet('FILE').to_csv('OUT.csv')\"` makes a CSV table",
    ),
    (
        0,
        b"ARROW1\0\0",
        "an Arrow (Feather) file",
        "`python -c \"import pandas; pandas.read_feather('FILE').to_csv('OUT.csv')\"` makes a CSV table",
    ),
    (
        0,
        b"\x93NUMPY",
        "a NumPy array",
        "`python -c \"import numpy; numpy.savetxt('OUT.csv', numpy.load('FILE'), delimiter=',')\"` makes a CSV table",
    ),
    (
        0,
        b"\xb5\x62",
        "a u-blox log (UBX)",
        "`pip install pyubx2`, or u-center, exports the messages NAV-PVT as CSV",
    ),
    (
        0,
        b"PK\x03\x04",
        "a ZIP archive (or a spreadsheet)",
        "expand it with `unzip FILE`, or export the spreadsheet as CSV",
    ),
    (
        0,
        b"7z\xbc\xaf\x27\x1c",
        "a 7z archive",
        "expand it with `7z x FILE`",
    ),
    (
        0,
        b"\xfd7zXZ\0",
        "compressed with xz",
        "expand it with `unxz FILE`",
    ),
    (
        4,
        b"1AY&SY",
        "compressed with bzip2",
        "expand it with `bunzip2 FILE`",
    ),
    (
        0,
        b"\x04\x22\x4d\x18",
        "compressed with LZ4 as a whole",
        "expand it with `lz4 -d FILE`",
    ),
    (
        257,
        b"ustar",
        "a tar archive",
        "expand it with `tar xf FILE`",
    ),
    (
        0,
        b"\xed\xa1\xda\x01",
        "an LCM log",
        "`lcm-export FILE` makes tables for MATLAB or Python, from which CSV is written",
    ),
    (
        0,
        b"RRF2",
        "a Rerun recording",
        "record with ROS 2 or MCAP, or export the columns as CSV",
    ),
    (
        0,
        b"MDF     ",
        "an ASAM MDF file",
        "`pip install asammdf`, then `asammdf` exports it as CSV",
    ),
    (
        0,
        b"LOGG\x90\0\0\0",
        "a CAN log (BLF)",
        "`pip install cantools`, then decode it with its DBC and write CSV",
    ),
    (0, b"\xd4\xc3\xb2\xa1", "a network capture (pcap)", TO_CSV),
    (0, b"\x0a\x0d\x0d\x0a", "a network capture (pcapng)", TO_CSV),
    (0, b"\xd0\xcf\x11\xe0", "a spreadsheet (XLS)", TO_CSV),
    (
        0,
        b"version https://git-lfs",
        "a pointer of Git LFS, not the log itself",
        "`git lfs pull` in its repository downloads the log",
    ),
    (
        0,
        b"<!DOCTYPE",
        "a web page, not the log itself",
        "download the raw file",
    ),
];
/// What a gzip file may hold beside a table.
const PACKED: &[&[u8]] = &[b"\x89MCAP", b"#ROSBAG"];

/// Refuses the kinds of files that are known and not read.
pub(crate) fn refuse(file: &str, start: &[u8]) -> Result<()> {
    let starts =
        |(at, mark, ..): &&Kind| start.get(*at..).is_some_and(|rest| rest.starts_with(mark));
    match KINDS.iter().find(starts) {
        Some((_, _, kind, advice)) => Err(Error::Foreign {
            file: file.to_owned(),
            kind,
            advice,
        }),
        None => Ok(()),
    }
}

/// Refuses what came out of gzip and is no text.
pub(crate) fn refuse_packed(file: &str, start: &[u8]) -> Result<()> {
    if PACKED.iter().any(|mark| start.starts_with(mark)) {
        return Err(Error::Foreign {
            file: file.to_owned(),
            kind: "an MCAP file or a bag, compressed with gzip as a whole",
            advice: "expand it with `gunzip FILE`",
        });
    }
    refuse(file, start)
}

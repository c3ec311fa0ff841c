//! Any bytes, read as a file of MERL. A file has 35 MB or 70, which no fuzzer guesses: behind a header with that
//! size the rest of the bytes is repeated until it has them.
#![no_main]

use brdf_measured::merl::parse;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    brdf_fuzz::held(parse(data));
    let Some((header, rest)) = data.split_at_checked(12) else { return };
    let size =
        |at: usize| header[at..at + 4].iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte));
    let wanted = match [size(0), size(4), size(8)] {
        [90, 90, p @ (180 | 360)] if !rest.is_empty() => 12 + 24 * 90 * 90 * p,
        _ => return,
    };
    let mut file = header.to_vec();
    file.reserve_exact(wanted - 12);
    while file.len() < wanted {
        let some = rest.len().min(wanted - file.len());
        file.extend_from_slice(&rest[..some]);
    }
    brdf_fuzz::held(parse(&file));
});

//! Times of benches over two calibrations, compared with those of a baseline.
//!
//! `benches docs/benches.json` reads the output of `cargo bench` from its input, prints a table and fails where a bench takes more than
//! [`SLOWER`] times its share of before; `benches docs/benches.json --record` writes the baseline instead. Rounds may follow one another
//! in the input: the least time of a bench counts, since other work on a machine only adds to it.

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::{env, fs, io};

use serde_json::{Value, json};

/// A bench that takes so many times its share of before has become slower. The benches scatter by less on a shared machine (`tests/README.md`).
const SLOWER: f64 = 1.5;

/// The calibrations of `tests/calibration.rs`.
const CALIBRATIONS: [&str; 2] = ["arithmetic", "memory"];

/// Times of a bench over those of the two calibrations in the same program.
type Shares = [f64; 2];

fn main() -> ExitCode {
    match run(&env::args().skip(1).collect::<Vec<_>>()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether no bench has become slower.
fn run(arguments: &[String]) -> Result<bool, String> {
    let (file, record) = match arguments {
        [file] => (file, false),
        [file, flag] if flag == "--record" => (file, true),
        _ => return Err("expected: cargo bench --workspace --bench '*' | benches BASELINE.json [--record]".into()),
    };
    let output = io::read_to_string(io::stdin()).map_err(|error| format!("input: {error}"))?;
    let times = least_times(&output);
    let now = shares(&times)?;
    if record {
        let baseline = json!({ "processor": processor(), "calibrations": CALIBRATIONS, "benches": rounded(&now) });
        let text = serde_json::to_string_pretty(&baseline).unwrap_or_default() + "\n";
        fs::write(file, text).map_err(|error| format!("{file}: {error}"))?;
        println!("{} benches recorded in {file}", now.len());
        return Ok(true);
    }
    let text = fs::read_to_string(file).map_err(|error| format!("{file}: {error}; --record writes it"))?;
    let (before, of) = baseline(&text).ok_or(format!("{file}: no baseline of benches; --record writes it"))?;
    if of != processor() {
        println!("the baseline is of another processor, {of}; this is {}", processor());
    }
    let (lines, kept) = compared(&now, &before);
    println!("{:<48} {:>12} {:>12} {:>12} {:>12}", "bench", "seconds", CALIBRATIONS[0], CALIBRATIONS[1], "of before");
    for (bench, line) in lines {
        println!("{bench:<48} {:>12.3e} {line}", times[&bench]);
    }
    // What is no longer timed would be compared with nothing for ever.
    let gone: Vec<_> = before.keys().filter(|bench| !now.contains_key(*bench)).collect();
    gone.iter().for_each(|bench| println!("{bench:<48} no longer timed; --record writes the baseline anew"));
    Ok(kept && gone.is_empty())
}

/// Least time [s] of every bench in the tables that divan prints, by program, function and argument.
fn least_times(output: &str) -> BTreeMap<String, f64> {
    let mut times = BTreeMap::new();
    let mut path: Vec<&str> = Vec::new();
    for line in output.lines() {
        // Branches are three characters wide, one per level below the program.
        let (level, text) = match line.find(['├', '╰']) {
            Some(at) => (1 + line[..at].chars().count() / 3, line[at..].trim_start_matches(['├', '╰', '─', ' '])),
            None if line.contains(" fastest ") => (0, line),
            None => continue,
        };
        // Two spaces at least lie between a name and the first column.
        let (name, columns) = text.split_once("  ").unwrap_or((text, ""));
        path.truncate(level);
        path.push(name.trim());
        if let Some(time) = columns.split('│').next().and_then(seconds) {
            let least: &mut f64 = times.entry(path.join("/")).or_insert(time);
            *least = least.min(time);
        }
    }
    times
}

/// A time as divan writes it, such as `12.5 µs`.
fn seconds(text: &str) -> Option<f64> {
    let (number, unit) = text.trim().split_once(' ')?;
    let units = [("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0), ("m", 60.0)];
    let (_, unit) = units.into_iter().find(|(name, _)| *name == unit)?;
    Some(number.parse::<f64>().ok()? * unit)
}

/// Shares of all benches but the calibrations.
fn shares(times: &BTreeMap<String, f64>) -> Result<BTreeMap<String, Shares>, String> {
    let mut shares = BTreeMap::new();
    for (bench, time) in times {
        let program = bench.split('/').next().unwrap_or_default();
        let mut share = [0.0; 2];
        for (share, name) in share.iter_mut().zip(CALIBRATIONS) {
            let key = format!("{program}/calibration/{name}");
            let calibration = times.get(&key);
            *share = time
                / calibration.ok_or(format!(
                    "no time of {key}: its program includes tests/calibration.rs, and the run must not leave it out"
                ))?;
        }
        if !bench.starts_with(&format!("{program}/calibration/")) {
            shares.insert(bench.clone(), share);
        }
    }
    if shares.is_empty() {
        return Err("no bench in the input; expected the output of cargo bench --workspace --bench '*'".into());
    }
    Ok(shares)
}

/// A line per bench, and whether none has become slower.
///
/// A bench is as slow as the kinder of its two shares says: where memory is slow tonight, what waits for it is no slower than memory.
fn compared(now: &BTreeMap<String, Shares>, before: &BTreeMap<String, Shares>) -> (Vec<(String, String)>, bool) {
    let mut kept = true;
    let line = |(bench, [arithmetic, memory]): (&String, &Shares)| {
        let verdict = before.get(bench).map_or("new".to_owned(), |of| {
            let change = (arithmetic / of[0]).min(memory / of[1]);
            kept &= change <= SLOWER;
            format!("{change:.2}{}", if change <= SLOWER { "" } else { " SLOWER" })
        });
        (bench.clone(), format!("{arithmetic:>12.4} {memory:>12.4} {verdict:>12}"))
    };
    (now.iter().map(line).collect(), kept)
}

/// Shares and processor of a baseline.
fn baseline(text: &str) -> Option<(BTreeMap<String, Shares>, String)> {
    let value: Value = serde_json::from_str(text).ok()?;
    let share = |value: &Value| Some([value.get(0)?.as_f64()?, value.get(1)?.as_f64()?]);
    let benches = value["benches"].as_object()?.iter().map(|(bench, value)| Some((bench.clone(), share(value)?)));
    Some((benches.collect::<Option<_>>()?, value["processor"].as_str()?.to_owned()))
}

/// Four digits: more are noise.
fn rounded(shares: &BTreeMap<String, Shares>) -> BTreeMap<&str, Shares> {
    let round = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
    shares.iter().map(|(bench, share)| (bench.as_str(), share.map(round))).collect()
}

/// The processor as Linux names it.
fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or("unknown".into(), |(_, name)| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rounds as divan prints them, the second with a slower machine but for `wide`.
    const OUTPUT: &str = "\
Timer precision: 20 ns
step                        fastest       │ slowest       │ median        │ mean          │ samples │ iters
├─ calibration                            │               │               │               │         │
│  ├─ arithmetic            500 µs        │ 900 µs        │ 600 µs        │ 610 µs        │ 100     │ 100
│  ╰─ memory                10 ms         │ 20 ms         │ 12 ms         │ 12.5 ms       │ 100     │ 100
├─ cells                                  │               │               │               │         │
│  ├─ (\"armed\", false, 0.7)  1.5 ms        │ 2 ms          │ 1.7 ms        │ 1.7 ms        │ 100     │ 100
│  │                        28 Mitem/s    │ 20 Mitem/s    │ 25 Mitem/s    │ 25 Mitem/s    │         │
│  ╰─ (\"damaged\", true, 0)  2.5 ms        │ 3 ms          │ 2.7 ms        │ 2.7 ms        │ 100     │ 100
╰─ wide                     1.2 s         │ 2 s           │ 1.3 s         │ 1.4 s         │ 5       │ 5

Timer precision: 20 ns
step                        fastest       │ slowest       │ median        │ mean          │ samples │ iters
├─ calibration                            │               │               │               │         │
│  ├─ arithmetic            700 µs        │ 900 µs        │ 600 µs        │ 610 µs        │ 100     │ 100
│  ╰─ memory                15 ms         │ 20 ms         │ 12 ms         │ 12.5 ms       │ 100     │ 100
╰─ wide                     1 s           │ 2 s           │ 1.3 s         │ 1.4 s         │ 5       │ 5
";

    fn shares_of(output: &str) -> BTreeMap<String, Shares> {
        shares(&least_times(output)).unwrap()
    }

    #[test]
    fn tables_are_read_and_the_least_of_the_rounds_counts() {
        let shares = shares_of(OUTPUT);
        let expected = [
            ("step/cells/(\"armed\", false, 0.7)", [3.0, 0.15]),
            ("step/cells/(\"damaged\", true, 0)", [5.0, 0.25]),
            ("step/wide", [2000.0, 100.0]),
        ];
        assert_eq!(shares.len(), expected.len());
        for (bench, expected) in expected {
            let off = shares[bench].iter().zip(expected).map(|(share, e)| (share / e - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12, "{bench}: {:?}", shares[bench]);
        }
    }

    #[test]
    fn a_slower_machine_or_slower_memory_makes_no_bench_slower() {
        let before = shares_of(OUTPUT);
        let same = |output: &str| compared(&shares_of(output), &before).1;
        assert!(same(
            &OUTPUT
                .replace(" ms  ", " s   ")
                .replace(" µs  ", " ms  ")
                .replace("1.2 s", "1200 s")
                .replace(" 1 s ", " 1000 s ")
        ));
        // Memory four times as slow, and `wide` with it.
        assert!(same(
            &OUTPUT
                .replace("10 ms ", "40 ms ")
                .replace("15 ms", "60 ms")
                .replace(" 1 s ", " 4 s ")
                .replace("1.2 s", "4.8 s")
        ));
    }

    #[test]
    fn a_bench_that_takes_longer_beside_the_same_calibrations_is_slower() {
        let before = shares_of(OUTPUT);
        let (lines, kept) = compared(&shares_of(&OUTPUT.replace(" 1.5 ms ", " 2.4 ms ")), &before);
        assert!(!kept);
        let slower: Vec<_> = lines.iter().filter(|(_, line)| line.contains("SLOWER")).collect();
        assert_eq!(slower.len(), 1);
        assert_eq!(slower[0].0, "step/cells/(\"armed\", false, 0.7)");
    }

    #[test]
    fn a_run_without_calibration_or_benches_is_an_error() {
        assert!(shares(&least_times(&OUTPUT.replace("memory", "other"))).is_err());
        assert!(shares(&least_times("error: could not compile")).is_err());
    }

    #[test]
    fn a_baseline_reads_back_as_it_was_written() {
        let now = shares_of(OUTPUT);
        let text = json!({ "processor": "of a test", "benches": rounded(&now) }).to_string();
        let (before, of) = baseline(&text).unwrap();
        assert_eq!(of, "of a test");
        assert!(compared(&now, &before).1);
        assert!(before.iter().all(|(bench, share)| (share[0] / now[bench][0] - 1.0).abs() < 1e-3));
        assert!(baseline("{}").is_none());
    }
}

//! Where results come from: case, overrides, input files, command and date.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// Where the results of a run come from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Path of the case file as given; its text is in the folder `input` of the results.
    pub case: String,
    /// `--set` pairs as `name=value`, in order.
    pub overrides: Vec<String>,
    /// Mesh and further files that the case reads.
    pub files: Vec<InputFile>,
    /// Command that runs the case like this.
    pub command: String,
    /// Folder in which it was given.
    pub folder: String,
    /// When it was given: date and time of day, UTC.
    pub started: String,
}

/// A file that a case reads.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Path as in the case file.
    pub file: String,
    /// XXH3 hash of 128 bits, 32 hexadecimal digits, as `xxhsum -H2` prints it.
    pub hash: String,
}

impl Origin {
    /// Names and values in words, for log and report.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![("command", self.command.clone()), ("in folder", self.folder.clone())];
        lines.push(("started", self.started.clone()));
        lines.extend(self.overrides.iter().map(|set| ("set", set.clone())));
        lines.extend(self.files.iter().map(|file| ("input", format!("{}, XXH3 {}", file.file, file.hash))));
        lines.retain(|(_, value)| !value.is_empty());
        lines
    }
}

/// Date and time of day in UTC, as `2026-03-01T14:05:09Z`.
pub fn utc(instant: SystemTime) -> String {
    let seconds = instant.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let [year, month, day] = date(days);
    let [hour, minute, second] = [second / 3600, second / 60 % 60, second % 60];
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Year, month and day of the Gregorian calendar, `days` after 1 January 1970. Years are counted from March, so that the
/// leap day is the last one: month m of such a year begins on its day (153 m + 2) / 5.
fn date(days: u64) -> [u64; 3] {
    // Days from 1 March of the year 0 to 1 January 1970.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 { (400 * era + year, month + 3) } else { (400 * era + year + 1, month - 9) };
    [year, month, day]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// Against `date -u -d @SECONDS +%FT%TZ`.
    #[test]
    fn dates_are_those_of_the_calendar() {
        let known = [
            (0, "1970-01-01T00:00:00Z"),
            (951_827_696, "2000-02-29T12:34:56Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ];
        for (seconds, text) in known {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
        for day in 0..80_000 {
            let [year, month, day] = date(day);
            assert!((1..=12).contains(&month) && (1..=31).contains(&day), "{year}-{month}-{day}");
        }
    }
}

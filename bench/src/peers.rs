//! Other programs on the same points, each a process that is told one job after the other, in turn with this library.
//!
//! A peer gets a file of points and a file for its answers (doubles, three a row) as arguments. It prints a line of
//! JSON with its versions, then reads jobs from its standard input, a line each: the job's name and its number, a radius
//! or a count. For each it prints a line of JSON with the CPU seconds, index included, and the kind of its answers.

use crate::answers::{Summary, failures, mean_angle, rms_distance, summary};
use crate::case::{Case, Cases, PeerGroup, PeerJob};
use crate::clock::{median, rounded};
use crate::cloud::{Sampled, Supports};
use crate::contest::{Contestant, contestant};
use crate::machine::circumstances;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Runs the groups (all, if none is named) with the peers that are there, and gives the record.
pub(crate) fn peers(
    cases: &Cases,
    only: &[String],
    peers: &[String],
    folder: &Path,
    repeats: Option<usize>,
) -> Result<Value, String> {
    let commands: BTreeMap<&str, &str> = peers.iter().filter_map(|peer| peer.split_once('=')).collect();
    let (mut groups, mut failed) = (Vec::new(), Vec::new());
    let start = circumstances();
    for group in cases.peers.iter().filter(|group| only.is_empty() || only.contains(&group.name)) {
        let mut contest = Contest::new(cases, group, &commands, folder)?;
        let repeats = repeats.unwrap_or(group.repeats);
        for repeat in 1..=repeats {
            eprintln!("{}: repeat {repeat} of {repeats}", group.name);
            contest.repeat()?;
        }
        groups.push(contest.finish(repeats, &mut failed));
    }
    Ok(json!({
        "bench": "peers",
        "circumstances": start,
        "time": "user and system seconds of the process with its index, median of the repeats, one thread",
        "groups": groups,
        "failures": failed,
    }))
}

/// A group of jobs under way.
struct Contest<'c> {
    group: &'c PeerGroup,
    sampled: Sampled,
    supports: Supports,
    own: Box<dyn Contestant>,
    own_seconds: Vec<f64>,
    peers: BTreeMap<&'c str, Result<Peer, String>>,
    results: Vec<JobResult<'c>>,
}

struct JobResult<'c> {
    job: &'c PeerJob,
    seconds: Vec<f64>,
    answers: Summary,
    /// Why it did not get done.
    failure: Option<String>,
}

impl<'c> Contest<'c> {
    fn new(
        cases: &'c Cases,
        group: &'c PeerGroup,
        commands: &BTreeMap<&str, &str>,
        folder: &Path,
    ) -> Result<Self, String> {
        let data = cases.data.get(&group.data).ok_or_else(|| format!("no data {}", group.data))?;
        let sampled = Sampled::new(data);
        let case = Case { degree: group.degree, ..Case::with(&group.data, group.neighbours) };
        let supports = sampled.supports(case.neighbours, case.support)?;
        let own = contestant(&case, &sampled, &supports)?;
        let points = folder.join(format!("{}.points", group.data));
        fs::write(&points, bytes(&sampled.points)).map_err(|e| format!("{}: {e}", points.display()))?;
        let mut peers: BTreeMap<&str, Result<Peer, String>> = BTreeMap::new();
        for job in &group.jobs {
            peers.entry(&job.peer).or_insert_with(|| {
                let command = commands.get(&*job.peer).ok_or("not installed")?;
                Peer::start(command, &points, folder.join(format!("{}.answers", job.peer)))
            });
        }
        let result = |job| JobResult { job, seconds: Vec::new(), answers: Summary::new(), failure: None };
        let results = group.jobs.iter().map(result).collect();
        Ok(Self { group, sampled, supports, own, own_seconds: Vec::new(), peers, results })
    }

    fn repeat(&mut self) -> Result<(), String> {
        self.own_seconds.push(self.own.time(self.group.own)?.cpu);
        for result in &mut self.results {
            let peer = match self.peers.get_mut(&*result.job.peer) {
                Some(Ok(peer)) if result.failure.is_none() => peer,
                Some(Err(error)) => {
                    result.failure = Some(error.clone());
                    continue;
                }
                _ => continue,
            };
            let number = match result.job.count {
                Some(count) => count.to_string(),
                None => self.supports.radius.to_string(),
            };
            match peer.ask(&result.job.job, &number) {
                Ok(reply) => {
                    result.seconds.push(reply.cpu);
                    result.answers = reply.summary(&self.sampled, self.supports.radius);
                }
                Err(error) => result.failure = Some(error),
            }
        }
        Ok(())
    }

    fn finish(self, repeats: usize, failed: &mut Vec<String>) -> Value {
        let own = median(self.own_seconds);
        let jobs: Vec<Value> = (self.results.iter())
            .map(|result| {
                let name = format!("{}/{} {}", self.group.name, result.job.peer, result.job.job);
                let mut record = Map::new();
                let mut put = |name: &str, value: Value| record.insert(name.to_owned(), value);
                put("peer", json!(result.job.peer));
                put("job", json!(result.job.job));
                put("equal", json!(result.job.equal));
                put("count", json!(result.job.count));
                if let Some(failure) = &result.failure {
                    put("failure", json!(failure));
                } else {
                    failed.extend(failures(&name, &result.answers, &result.job.expected));
                    let seconds = median(result.seconds.iter().copied());
                    put("cpu_seconds", json!(rounded(seconds)));
                    put("against_footpoint", json!(rounded(seconds / own)));
                    put("answers", json!(result.answers));
                }
                Value::Object(record)
            })
            .collect();
        let versions: Map<String, Value> = (self.peers.iter())
            .filter_map(|(name, peer)| Some(((*name).to_owned(), peer.as_ref().ok()?.versions.clone())))
            .collect();
        let stage = self.group.own.name();
        let own_answers = summary(self.own.as_ref(), &self.sampled, self.supports.radius);
        json!({
            "group": self.group.name,
            "samples": self.sampled.points.len(),
            "neighbours": self.group.neighbours.mean,
            "repeats": repeats,
            "footpoint": { "job": stage, "degree": self.group.degree, "cpu_seconds": rounded(own), "answers": own_answers },
            "versions": versions,
            "jobs": jobs,
        })
    }
}

/// A process that takes jobs.
struct Peer {
    child: Child,
    jobs: ChildStdin,
    replies: BufReader<ChildStdout>,
    answers: PathBuf,
    versions: Value,
}

/// What a peer answered.
struct Reply {
    cpu: f64,
    kind: String,
    rows: Vec<[f64; 3]>,
}

impl Peer {
    fn start(command: &str, points: &Path, answers: PathBuf) -> Result<Self, String> {
        let mut words = command.split_whitespace();
        let program = words.next().ok_or("no command")?;
        let mut command = Command::new(program);
        // Libraries that count cores instead of asking would be measured with all their threads' idling.
        for name in ["OMP_NUM_THREADS", "TBB_NUM_THREADS", "OPENBLAS_NUM_THREADS"] {
            command.env(name, "1");
        }
        command.args(words).arg(points).arg(&answers).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|e| format!("{program}: {e}"))?;
        let jobs = child.stdin.take().ok_or("no standard input")?;
        let replies = BufReader::new(child.stdout.take().ok_or("no standard output")?);
        let mut peer = Self { child, jobs, replies, answers, versions: Value::Null };
        peer.versions = peer.read()?;
        Ok(peer)
    }

    fn ask(&mut self, job: &str, number: &str) -> Result<Reply, String> {
        writeln!(self.jobs, "{job} {number}").map_err(|e| e.to_string())?;
        let reply = self.read()?;
        match (reply["cpu"].as_f64(), reply["kind"].as_str()) {
            (Some(cpu), Some(kind)) => {
                let rows = rows(&fs::read(&self.answers).map_err(|e| e.to_string())?);
                Ok(Reply { cpu, kind: kind.to_owned(), rows })
            }
            _ => Err(reply.to_string()),
        }
    }

    /// The next line that is JSON: libraries like to talk on the standard output too.
    fn read(&mut self) -> Result<Value, String> {
        loop {
            let mut line = String::new();
            match self.replies.read_line(&mut line).map_err(|e| e.to_string())? {
                0 => return Err("the program ended".to_owned()),
                _ => {
                    if let Ok(value @ Value::Object(_)) = serde_json::from_str(&line) {
                        return Ok(value);
                    }
                }
            }
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It may have ended already, and then there is nothing to end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Reply {
    fn summary(&self, sampled: &Sampled, radius: f64) -> Summary {
        let share = self.rows.len() as f64 / sampled.points.len() as f64;
        let answer = match &*self.kind {
            "normals" => ("normal_angle", mean_angle(sampled, &sampled.points, &self.rows)),
            _ => ("projected_rms", rms_distance(sampled, &self.rows) / radius),
        };
        [("share", share), answer].map(|(name, value)| (name.to_owned(), value)).into()
    }
}

fn bytes(rows: &[[f64; 3]]) -> Vec<u8> {
    rows.iter().flatten().flat_map(|c| c.to_le_bytes()).collect()
}

fn rows(bytes: &[u8]) -> Vec<[f64; 3]> {
    let (numbers, _) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = numbers.iter().map(|number| f64::from_le_bytes(*number)).collect();
    numbers.as_chunks::<3>().0.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_survive_the_way_through_a_file() {
        let all = vec![[1.0, -2.5, 1e300], [f64::MIN_POSITIVE, 0.0, -0.0]];
        assert_eq!(rows(&bytes(&all)), all);
    }
}

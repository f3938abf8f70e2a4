//! A report as Markdown tables.

use crate::measure::Differences;
use crate::report::{
    Line, Machine, MeshReport, Ratio, Report, SetReport, kinds, lines, structures, wavefront_lines,
};
use std::io::{Result, Write};

const ABSENT: &str = "absent";

/// Writes all tables, and the machine and command below them.
pub(crate) fn write(out: &mut impl Write, report: &Report) -> Result<()> {
    let meshes = &report.meshes;
    let heads = |what: &str| [vec![what.to_owned()], meshes.iter().map(head).collect()].concat();
    let by_line = |lines: Vec<Line>, cell: fn(&Line, &MeshReport) -> Option<String>| {
        let cells = move |line: &Line| {
            let cell = |mesh| cell(line, mesh).unwrap_or_else(|| ABSENT.to_owned());
            [vec![line.name.clone()], meshes.iter().map(cell).collect()].concat()
        };
        lines.iter().map(cells).collect()
    };
    let means = [heads("ratios"), vec!["geometric means".to_owned()]].concat();
    writeln!(out, "Each cell: {}.\n", kinds())?;
    write_table(out, &heads("million rays per second"), by_line(lines(meshes), speeds))?;
    write_table(out, &means, report.ratios.iter().map(ratios).collect())?;
    write_table(out, &heads("missed + invented + elsewhere"), by_line(structures(meshes), differences))?;
    write_table(out, &heads("build: seconds, bytes per triangle"), by_line(structures(meshes), build))?;
    for mesh in meshes.iter().filter(|mesh| !mesh.wavefronts.is_empty()) {
        write_wavefronts(out, mesh, &wavefront_lines(meshes))?;
    }
    write_machine(out, &report.machine)
}

/// The integrator's rays: million rays per second, and the ratios of the first line to the others in brackets.
fn write_wavefronts(out: &mut impl Write, mesh: &MeshReport, lines: &[Line]) -> Result<()> {
    let heads: Vec<_> = [format!("{}: rays of wavefronts", mesh.mesh), "thousand rays".to_owned()]
        .into_iter()
        .chain(lines.iter().map(|line| line.name.clone()))
        .collect();
    let row = |(at, set): (usize, &SetReport)| {
        let ours = lines.first().and_then(|line| line.wavefront_speed(mesh, at));
        let cell = |(i, line): (usize, &Line)| match (ours, line.wavefront_speed(mesh, at)) {
            (_, None) => ABSENT.to_owned(),
            (Some(ours), Some(speed)) if i > 0 => format!("{speed:.1} ({:.2})", ours / speed),
            (_, Some(speed)) => format!("{speed:.1}"),
        };
        let flag = if set.is_small { " (few)" } else { "" };
        let cells = lines.iter().enumerate().map(cell);
        [set.name.clone(), format!("{}{flag}", set.rays / 1000)].into_iter().chain(cells).collect()
    };
    write_table(out, &heads, mesh.wavefronts.iter().enumerate().map(row).collect())
}

fn head(mesh: &MeshReport) -> String {
    format!("{} ({} k)", mesh.mesh, mesh.triangles / 1000)
}

fn speeds(line: &Line, mesh: &MeshReport) -> Option<String> {
    line.speeds(mesh).map(figures)
}

fn ratios(ratio: &Ratio) -> Vec<String> {
    let cells = ratio.by_mesh.iter().chain([&ratio.means]);
    let cells = cells.map(|cell| cell.map_or_else(|| ABSENT.to_owned(), figures)).collect();
    [vec![format!("{} : {}", ratio.ours, ratio.peer)], cells].concat()
}

/// The largest numbers of differences of the structure's modes.
fn differences(line: &Line, mesh: &MeshReport) -> Option<String> {
    let all = line.rows(mesh).map(|row| row.outcomes.map(|outcome| outcome.differences));
    let most = all.reduce(|a, b| {
        std::array::from_fn(|kind| Differences {
            missed: a[kind].missed.max(b[kind].missed),
            invented: a[kind].invented.max(b[kind].invented),
            elsewhere: a[kind].elsewhere.max(b[kind].elsewhere),
        })
    })?;
    Some(most.map(|d| format!("{} + {} + {}", d.missed, d.invented, d.elsewhere)).join(" / "))
}

fn build(line: &Line, mesh: &MeshReport) -> Option<String> {
    let build = line.rows(mesh).next()?.build;
    let bytes = build.bytes.map_or_else(|| "?".to_owned(), |bytes| (bytes / mesh.triangles).to_string());
    Some(format!("{:.2}, {bytes}", build.seconds))
}

fn figures(numbers: [f64; 3]) -> String {
    numbers.map(|x| if x < 10.0 { format!("{x:.2}") } else { format!("{x:.1}") }).join(" / ")
}

fn write_table(out: &mut impl Write, heads: &[String], rows: Vec<Vec<String>>) -> Result<()> {
    writeln!(out, "| {} |", heads.join(" | "))?;
    writeln!(out, "|---|{}", "---:|".repeat(heads.len() - 1))?;
    for row in rows {
        writeln!(out, "| {} |", row.join(" | "))?;
    }
    writeln!(out)
}

fn write_machine(out: &mut impl Write, machine: &Machine) -> Result<()> {
    let Machine { cpu, rustc, rustflags, embree, date, command } = machine;
    writeln!(
        out,
        "{cpu}, one thread; {rustc}, RUSTFLAGS \"{rustflags}\"; Embree {embree}; {date}: `{command}`"
    )
}

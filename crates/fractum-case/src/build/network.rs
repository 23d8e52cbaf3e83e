//! Joints and grains of a case, cut into its mesh.

use fractum_math::elementary::cbrt;
use fractum_mesh::quality::{area_vector, signed_volume, summarize_tetrahedra, summarize_triangles};
use fractum_mesh::{
    Cutting, Disc, Fate, JointGroup, Mesh, NetworkError, Orientation, Trace, Vec3, mean_dip, mean_direction,
};
use fractum_output::number::{quantity, significant};
use fractum_output::warning::Code;

use crate::model::{GrainsWithin, JointSource, Joints, Network};
use crate::{Diagnostic, Diagnostics, Field, Place, Spanned, nearest};

/// The least angle at which two joints may meet [deg].
const LEAST_ANGLE: f64 = 15.0;
/// Share of the joints of a set in the body that may be left out without a warning.
const MOST_LEFT_OUT: f64 = 0.25;
/// Elements across a grain at least.
const ACROSS: f64 = 3.0;

/// Cuts joints and grains into a mesh; what was made of them is told in its notices.
///
/// - returns what is doubtful
///
/// # Errors
/// Groups that are not there, joints outside of the bodies, and what cannot be cut.
pub fn cut_network(network: &Network, mesh: &mut Mesh) -> Result<Vec<Diagnostic>, Diagnostics> {
    if network.is_empty() {
        return Ok(Vec::new());
    }
    let mut warnings = Vec::new();
    let before = shortest(mesh);
    if !network.joints.is_empty() {
        warnings = cut_joints(&network.joints, mesh)?;
    }
    if let Some(grains) = &network.grains {
        divide(grains, mesh)?;
    }
    let (before, after) = (quantity(before, "m"), quantity(shortest(mesh), "m"));
    mesh.notices.push(format!("shortest altitude of an element {after}, {before} before it was cut"));
    Ok(warnings)
}

/// The shortest altitude of the elements of a mesh, to which the time step is proportional.
fn shortest(mesh: &Mesh) -> f64 {
    let of_triangles = || summarize_triangles(&mesh.nodes, &mesh.triangles);
    let summary = summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra).or_else(of_triangles);
    summary.map_or(0.0, |summary| summary.shortest_altitude.value)
}

/// Groups of elements by name, which must be there.
fn groups(mesh: &Mesh, named: &[Spanned<String>]) -> Result<Vec<String>, Diagnostics> {
    let dimension = if mesh.tetrahedra.is_empty() { 2 } else { 3 };
    let there: Vec<&str> =
        mesh.groups.iter().filter(|group| group.dimension == dimension).map(|group| group.name.as_str()).collect();
    let wrong = named.iter().filter(|name| !there.contains(&name.value.as_str())).map(|name| {
        let note = Diagnostic::error(&name.place, format!("= \"{}\"", name.value));
        let note = note.expected(format!("a mesh group of elements; there are: {}", there.join(", ")));
        match nearest(&name.value, there.iter().copied()) {
            Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
            None => note,
        }
    });
    let wrong: Vec<Diagnostic> = wrong.collect();
    if wrong.is_empty() {
        return Ok(named.iter().map(|name| name.value.clone()).collect());
    }
    Err(Diagnostics::of_many(wrong))
}

fn one(place: &Place, found: String, expected: &str, remedy: &str) -> Diagnostics {
    let note = Diagnostic::error(place, found);
    let note = if expected.is_empty() { note } else { note.expected(expected) };
    Diagnostics::of_many(vec![if remedy.is_empty() { note } else { note.remedy(remedy) }])
}

/// Whether each element is in one of some groups, all where none is named, and its middle where a condition holds; nothing where that is every element.
fn elements(mesh: &Mesh, within: &[Spanned<String>], condition: Option<&Field>) -> Result<Vec<bool>, Diagnostics> {
    let within = groups(mesh, within)?;
    if within.is_empty() && condition.is_none() {
        return Ok(Vec::new());
    }
    let is_plane = mesh.tetrahedra.is_empty();
    let count = if is_plane { mesh.triangles.len() } else { mesh.tetrahedra.len() };
    let mut allowed = vec![within.is_empty(); count];
    for group in mesh.groups.iter().filter(|group| within.contains(&group.name)) {
        let members = if is_plane { &group.triangles } else { &group.tetrahedra };
        members.iter().for_each(|&member| allowed[member as usize] = true);
    }
    if let Some(condition) = condition {
        for (element, allowed) in allowed.iter_mut().enumerate() {
            *allowed &= condition.holds_at(middle(mesh, element));
        }
    }
    Ok(allowed)
}

fn corners(mesh: &Mesh, element: usize) -> Vec<Vec3> {
    let nodes = if mesh.tetrahedra.is_empty() { &mesh.triangles[element][..] } else { &mesh.tetrahedra[element][..] };
    nodes.iter().map(|&node| mesh.nodes[node as usize]).collect()
}

fn middle(mesh: &Mesh, element: usize) -> Vec3 {
    let corners = corners(mesh, element);
    corners.iter().sum::<Vec3>() / corners.len() as f64
}

/// Size of the elements that are allowed, and the box around them.
fn extent(mesh: &Mesh, allowed: &[bool]) -> (f64, [Vec3; 2]) {
    let count = if mesh.tetrahedra.is_empty() { mesh.triangles.len() } else { mesh.tetrahedra.len() };
    let (mut size, mut low, mut high) = (0.0, Vec3::from_element(f64::INFINITY), Vec3::from_element(f64::NEG_INFINITY));
    for element in (0..count).filter(|&element| allowed.get(element) != Some(&false)) {
        let corners = corners(mesh, element);
        size += match corners[..] {
            [a, b, c] => area_vector([a, b, c]).norm(),
            [a, b, c, d] => signed_volume([a, b, c, d]),
            _ => 0.0,
        };
        corners.iter().for_each(|corner| (low, high) = (low.inf(corner), high.sup(corner)));
    }
    (size, [low, high])
}

/// The parts of a trace where a condition holds.
fn parts(ends: [[f64; 2]; 2], z: f64, condition: Option<&Field>) -> Vec<[[f64; 2]; 2]> {
    /// Places at which the condition is looked at.
    const LOOKS: usize = 400;
    let Some(condition) = condition else { return vec![ends] };
    let at = |look: usize| {
        let share = look as f64 / LOOKS as f64;
        [0, 1].map(|axis| ends[0][axis] + share * (ends[1][axis] - ends[0][axis]))
    };
    let (mut parts, mut begin) = (Vec::new(), None);
    for look in 0..=LOOKS {
        let [x, y] = at(look);
        match (condition.holds_at(Vec3::new(x, y, z)), begin) {
            (true, None) => begin = Some(look),
            (false, Some(first)) => {
                parts.push([at(first), at(look - 1)]);
                begin = None;
            }
            _ => {}
        }
    }
    parts.extend(begin.map(|first| [at(first), at(LOOKS)]));
    parts
}

/// All joints of a case in one list, and where those of each table or set begin.
#[derive(Default)]
struct AllJoints {
    traces: Vec<Trace>,
    discs: Vec<Disc>,
    /// Where each stands; none of sets.
    places: Vec<Option<Place>>,
    begin: Vec<usize>,
    groups: Vec<JointGroup>,
}

fn cut_joints(joints: &[Joints], mesh: &mut Mesh) -> Result<Vec<Diagnostic>, Diagnostics> {
    let mut all = AllJoints::default();
    for own in joints {
        add(&mut all, own, mesh)?;
    }
    all.begin.push(all.places.len());
    let least = LEAST_ANGLE.to_radians();
    let extents: Vec<f64> = all.groups.iter().map(|group| extent(mesh, &group.elements).0).collect();
    let cutting = if mesh.tetrahedra.is_empty() {
        mesh.cut_traces(&all.traces, &all.groups, least)
    } else {
        mesh.cut_discs(&all.discs, &all.groups, least)
    };
    let cutting = cutting.map_err(|error| refused(&joints[0].place, &error))?;
    let wrong: Vec<Diagnostic> =
        all.places.iter().zip(&cutting.fates).filter_map(|(place, fate)| misfit(place.as_ref()?, fate)).collect();
    if !wrong.is_empty() {
        return Err(Diagnostics::of_many(wrong));
    }
    let mut warnings = Vec::new();
    for (number, own) in joints.iter().enumerate() {
        let range = all.begin[number]..all.begin[number + 1];
        let fates = &cutting.fates[range.clone()];
        if !fates.iter().any(|fate| matches!(fate, Fate::Cut(_))) {
            let found = ": none of its joints is in the body".to_owned();
            let remedy = "a smaller spacing, longer joints, or smaller elements (mesh.halvings)";
            return Err(one(&own.place, found, "joints that are longer than an element", remedy));
        }
        mesh.notices.push(told(own, fates, &all, range, extents[number]));
        warnings.extend(left_out(own, fates));
    }
    mesh.notices.push(moved(&cutting, mesh.tetrahedra.is_empty()));
    Ok(warnings)
}

fn add(all: &mut AllJoints, own: &Joints, mesh: &Mesh) -> Result<(), Diagnostics> {
    let condition = own.condition.as_ref().map(|condition| &condition.value);
    let allowed = elements(mesh, &own.within, condition)?;
    if let Some(condition) = own.condition.as_ref().filter(|_| !allowed.contains(&true)) {
        return Err(one(
            &condition.place,
            "holds in no element of these groups".to_owned(),
            "a place in the bodies",
            "",
        ));
    }
    let is_plane = mesh.tetrahedra.is_empty();
    let z = mesh.nodes.first().map_or(0.0, |node| node.z);
    let group = all.groups.len() as u32;
    all.begin.push(all.places.len());
    let fits = match &own.source {
        JointSource::Set(set) => matches!(set.orientation, Orientation::Angle(_)) == is_plane,
        JointSource::Traces(_) => is_plane,
        JointSource::Discs(_) => !is_plane,
    };
    if !fits {
        let [expected, remedy] = if is_plane {
            ["joints of a plane mesh", "angle instead of dip and dip_direction, or a table of x, y, x, y"]
        } else {
            [
                "joints of a mesh in space",
                "dip and dip_direction instead of angle, or a table of x, y, z, dip, dip direction, diameter",
            ]
        };
        return Err(one(&own.place, " does not fit the mesh".to_owned(), expected, remedy));
    }
    match &own.source {
        JointSource::Set(set) => {
            let (_, [low, high]) = extent(mesh, &allowed);
            // Numbers that no memory takes are asked for by a unit that was forgotten.
            let across = (high - low).norm();
            let of_each = set.length.map_or(1.0, |length| (across / length).max(1.0));
            let planes = across / set.spacing * if is_plane { 1.0 } else { of_each };
            if planes * of_each > 1e6 {
                return Err(one(
                    &own.place,
                    "has more than a million joints".to_owned(),
                    "",
                    "a larger spacing or length, with its unit",
                ));
            }
            if is_plane {
                let traces = set.traces([[low.x, low.y], [high.x, high.y]]);
                let traces = traces.into_iter().flat_map(|trace| parts(trace.ends, z, condition));
                all.traces.extend(traces.map(|ends| Trace { ends, group }));
            } else {
                all.discs.extend(set.discs([low, high]).into_iter().map(|disc| Disc { group, ..disc }));
            }
            let count = if is_plane { all.traces.len() } else { all.discs.len() };
            all.places.resize(count, None);
        }
        JointSource::Traces(traces) => {
            for (ends, place) in traces {
                let whole = parts(*ends, z, condition);
                all.places.extend(whole.iter().map(|_| Some(place.clone())));
                all.traces.extend(whole.into_iter().map(|ends| Trace { ends, group }));
            }
        }
        JointSource::Discs(discs) => {
            all.discs.extend(discs.iter().map(|(disc, _)| Disc { group, ..*disc }));
            all.places.extend(discs.iter().map(|(_, place)| Some(place.clone())));
        }
    }
    all.groups.push(JointGroup { name: own.name.clone(), elements: allowed });
    Ok(())
}

fn refused(place: &Place, error: &NetworkError) -> Diagnostics {
    let remedy = match error {
        NetworkError::Kind => "a mesh of triangles with one z, or of tetrahedra",
        NetworkError::Overlap => {
            "mesh bodies that touch with common nodes, and set mesh.join where they have their own"
        }
        NetworkError::Taken(_) => "another name",
        NetworkError::Unfilled { .. } => "another seed, or smaller elements (mesh.halvings)",
    };
    one(place, format!(": {error}"), "", remedy)
}

/// What is wrong about a joint of a table.
fn misfit(place: &Place, fate: &Fate) -> Option<Diagnostic> {
    let note = |found: String, expected: &str, remedy: &str| {
        Some(Diagnostic::error(place, found).expected(expected.to_owned()).remedy(remedy.to_owned()))
    };
    match fate {
        Fate::Cut(_) => None,
        Fate::Outside => note(
            "this joint is outside of the bodies".to_owned(),
            "a joint in the mesh groups of within",
            "compare with the box that fractum mesh info tells, and mesh.unit",
        ),
        Fate::Short { length, edge } => note(
            format!("this joint is {} long, and an element there {}", quantity(*length, "m"), quantity(*edge, "m")),
            "a joint longer than an element",
            "leave it out, or take smaller elements (mesh.halvings)",
        ),
        Fate::Unfilled(at) => {
            let [x, y] = at.map(|x| quantity(x, "m"));
            note(
                format!("no triangles fill the mesh around this joint, near ({x}, {y})"),
                "room for elements beside it",
                "smaller elements (mesh.halvings), or leave out the joint that comes near to it there",
            )
        }
        Fate::Sharp { other, angle, at } => {
            let with = other.map_or("a side of the body".to_owned(), |other| format!("joint {}", other + 1));
            let [x, y] = at.map(|x| quantity(x, "m"));
            note(
                format!("this joint meets {with} at {:.0} deg, or lies upon it, near ({x}, {y})", angle.to_degrees()),
                &format!("joints that meet at {LEAST_ANGLE} deg or more, and are an element apart elsewhere"),
                "let it end before, or leave one of them out",
            )
        }
    }
}

/// What became of the joints of a table or set, in words.
fn told(own: &Joints, fates: &[Fate], all: &AllJoints, range: std::ops::Range<usize>, extent: f64) -> String {
    let is_plane = all.discs.is_empty();
    let cut: Vec<usize> = range.clone().filter(|&joint| matches!(fates[joint - range.start], Fate::Cut(_))).collect();
    let sizes = fates.iter().map(|fate| if let Fate::Cut(size) = fate { *size } else { 0.0 });
    let sum: f64 = sizes.sum();
    let measured = format!("{} {} 1/m", if is_plane { "P21" } else { "P32" }, significant(sum / extent, 4));
    let asked = match &own.source {
        JointSource::Set(set) => format!(" (asked {})", significant(set.persistence / set.spacing, 4)),
        _ => String::new(),
    };
    let direction = if is_plane {
        let (mean, deviation) = mean_direction(cut.iter().map(|&joint| all.traces[joint].ends));
        format!("angle {:.1} deg, deviation {:.1}", mean.to_degrees(), deviation.to_degrees())
    } else {
        let ([dip, direction], deviation) = mean_dip(cut.iter().map(|&joint| all.discs[joint]));
        let [dip, direction, deviation] = [dip, direction, deviation].map(f64::to_degrees);
        format!("dip {dip:.1} deg to {direction:.1}, deviation {deviation:.1}")
    };
    let left = reasons(fates);
    let left = if left.is_empty() { String::new() } else { format!("; {}", left.join(", ")) };
    let size = quantity(sum, if is_plane { "m" } else { "m^2" });
    format!("{} \"{}\": {} joints, {size}, {measured}{asked}, {direction}{left}", own.place.key, own.name, cut.len())
}

/// Why joints in the body are left out, and how many for each reason.
fn reasons(fates: &[Fate]) -> Vec<String> {
    let count = |is: fn(&Fate) -> bool| fates.iter().filter(|fate| is(fate)).count();
    let sharp = count(|fate| matches!(fate, Fate::Sharp { .. }));
    let unfilled = count(|fate| matches!(fate, Fate::Unfilled(_)));
    let short = count(|fate| matches!(fate, Fate::Short { .. }));
    let mut left = Vec::new();
    if sharp > 0 {
        left.push(format!("{sharp} left out that meet others at less than {LEAST_ANGLE} deg"));
    }
    if unfilled > 0 {
        left.push(format!("{unfilled} around which no triangles fit"));
    }
    if short > 0 {
        left.push(format!("{short} shorter than an element"));
    }
    left
}

fn left_out(own: &Joints, fates: &[Fate]) -> Option<Diagnostic> {
    let inside = fates.iter().filter(|fate| !matches!(fate, Fate::Outside)).count();
    let left = inside - fates.iter().filter(|fate| matches!(fate, Fate::Cut(_))).count();
    (left as f64 > MOST_LEFT_OUT * inside as f64).then(|| {
        let found = format!(": {left} of {inside} joints are not in the mesh: {}", reasons(fates).join(", "));
        let note = Diagnostic::warning(Code::JointsLeftOut, &own.place, found);
        note.remedy("less scatter, a larger spacing or longer joints; smaller elements (mesh.halvings) bear joints that are nearer and shorter")
    })
}

fn moved(cutting: &Cutting, is_plane: bool) -> String {
    let shift = quantity(cutting.shift, "m");
    if is_plane {
        let turn = cutting.turn.to_degrees();
        format!(
            "joints are straight but for parts turned by up to {turn:.1} deg; ends and crossings moved by up to {shift}"
        )
    } else {
        format!("faces of joints lie in their planes to {shift}; the rims of discs follow the elements")
    }
}

fn divide(own: &GrainsWithin, mesh: &mut Mesh) -> Result<(), Diagnostics> {
    let allowed = elements(mesh, &own.within, None)?;
    let is_plane = mesh.tetrahedra.is_empty();
    let grains = &own.grains;
    let (size, [low, high]) = extent(mesh, &allowed);
    let all = if is_plane { mesh.triangles.len() } else { mesh.tetrahedra.len() };
    let count = (0..all).filter(|&element| allowed.get(element) != Some(&false)).count() as f64;
    let edge = if is_plane { (size / count * 4.0 / 3.0f64.sqrt()).sqrt() } else { cbrt(size / count * 8.48) };
    if grains.size < ACROSS * edge {
        let found = format!(".size = {}, and an element is {}", quantity(grains.size, "m"), quantity(edge, "m"));
        let remedy = "larger grains, or smaller elements (mesh.halvings)";
        return Err(one(&own.place, found, "grains of three elements at least", remedy));
    }
    if grains.size > 0.5 * (high - low).norm() {
        let found =
            format!(".size = {}, and the body is {}", quantity(grains.size, "m"), quantity((high - low).norm(), "m"));
        return Err(one(&own.place, found, "grains much smaller than the body", "give the size with its unit"));
    }
    let made = mesh.divide_into_grains(grains, &allowed).map_err(|error| refused(&own.place, &error))?;
    let mean = made.sizes.iter().sum::<f64>() / made.count.max(1) as f64;
    let diameter =
        if is_plane { (4.0 * mean / std::f64::consts::PI).sqrt() } else { cbrt(6.0 * mean / std::f64::consts::PI) };
    let unit = if is_plane { "m" } else { "m^2" };
    mesh.notices.push(format!(
        "{}: {} grains of {} in the mean, boundaries of {}; {}",
        own.place.key,
        made.count,
        quantity(diameter, "m"),
        quantity(made.boundary, unit),
        if is_plane {
            format!("corners moved by up to {}", quantity(made.shift, "m"))
        } else {
            "boundaries follow the elements and are rough".to_owned()
        }
    ));
    Ok(())
}

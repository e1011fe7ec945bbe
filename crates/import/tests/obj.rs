//! OBJ and MTL files written here, with everything that the format allows, and with mistakes.

mod prism;

use std::fmt::Write as _;
use std::path::Path;

use octray_import::{Imported, InMemory, Options, obj};
use octray_math::DVec3;
use octray_scene::{Color, Material, Pigment, Shape};
use prism::{Prism, check_refused, mesh_of, messages, only_mesh};

fn import_with(text: &str, others: &[(&str, &str)]) -> Imported {
    let mut files = InMemory::default();
    for (name, content) in others {
        files.insert(*name, content.as_bytes());
    }
    let bytes = text.as_bytes().to_vec();
    obj::import(Path::new("parts/a.obj"), bytes, &files, &Options::default())
}

fn import(text: &str) -> Imported {
    import_with(text, &[])
}

fn write(prism: &Prism) -> String {
    let mut text = String::from("# a prism\n");
    for p in &prism.positions {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("a string");
    }
    for face in &prism.faces {
        text.push('f');
        for i in face {
            write!(text, " {}", i + 1).expect("a string");
        }
        text.push('\n');
    }
    text
}

#[test]
fn polygons_of_any_outline_give_the_right_polyhedron() {
    for prism in [
        Prism::regular(3, 0.5),
        Prism::regular(40, 2.0),
        Prism::star(9, 0.3, 1.0),
    ] {
        prism.check(only_mesh(&import(&write(&prism))), 1e-12);
    }
}

#[test]
fn ways_of_writing_do_not_matter() {
    let prism = Prism::star(5, 0.5, 1.0);
    let plain = write(&prism);
    let expected = import(&plain);
    let negative = plain
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(corners) => {
                let back = |c: &str| c.parse::<i64>().expect("an index") - 1 - 20;
                let corners = corners.split(' ').map(|c| format!(" {}", back(c)));
                format!("f{}\n", corners.collect::<String>())
            }
            None => format!("{line}\n"),
        })
        .collect();
    let mut faces_first: Vec<&str> = plain.lines().rev().collect();
    faces_first.sort_by_key(|line| !line.starts_with('f'));
    let variants: [String; 6] = [
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        format!("\u{feff}{plain}"),
        plain.replace(' ', "  \t \\\n "),
        plain.replace("\nf", " # remark\n\n   f"),
        negative,
    ];
    for text in variants {
        assert_eq!(only_mesh(&import(&text)), only_mesh(&expected), "{text}");
    }
}

#[test]
fn faces_may_come_before_their_vertices() {
    let imported = import("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_eq!(only_mesh(&imported).triangles(), [[0, 1, 2]]);
}

#[test]
fn groups_and_objects_become_objects_with_names() {
    let imported = import(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\no box\nf 1 2 4\ng lid  left\nf 1 3 4\n\
         o rest\nf 2 3 4\no box\nf 3 2 1\n",
    );
    let scene = imported.scene.expect("valid");
    let names: Vec<&str> = scene.objects().iter().map(|o| &*o.name).collect();
    assert_eq!(names, ["a", "box", "box/lid left", "rest"]);
    let counts = scene.objects().iter().map(|o| mesh_of(o).triangles().len());
    assert_eq!(counts.collect::<Vec<_>>(), [1, 2, 1, 1]);
    // Each has only the vertices it uses.
    assert_eq!(
        mesh_of(&scene.objects()[2]).positions(),
        [DVec3::ZERO, DVec3::Y, DVec3::Z]
    );
}

#[test]
fn normals_and_texture_coordinates_go_by_corner() {
    let imported = import(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0.5 9\nvn 0 0 2\nvn 1 0 0\n\
         f 1/1/1 2/2/1 3//2\nf 2 4 3\n",
    );
    let mesh = only_mesh(&imported);
    let normals = mesh.normals().expect("normals");
    let at = |t: usize, c: usize| normals.values[normals.triangles[t][c] as usize];
    assert_eq!(
        [at(0, 0), at(0, 1), at(0, 2)],
        [DVec3::Z * 2.0, DVec3::Z * 2.0, DVec3::X]
    );
    assert_eq!([at(1, 0), at(1, 1), at(1, 2)], [DVec3::ZERO; 3]);
    let uv = mesh.texcoords().expect("texture coordinates");
    assert_eq!(
        uv.values[uv.triangles[0][1] as usize].to_array(),
        [1.0, 0.5]
    );
}

#[test]
fn smoothing_groups_give_a_cylinder_s_normals() {
    let prism = Prism::regular(24, 1.0);
    let text = write(&prism);
    // The lids come first; the sides, all of one size, are smooth.
    let mut lines: Vec<&str> = text.lines().collect();
    let sides = lines.len() - 24;
    lines.insert(sides, "s 3");
    let imported = import(&lines.join("\n"));
    let mesh = only_mesh(&imported);
    let normals = mesh.normals().expect("smooth");
    let mut smooth = 0;
    for (corners, indices) in mesh.triangles().iter().zip(&normals.triangles) {
        for (corner, index) in corners.iter().zip(indices) {
            let normal = normals.values[*index as usize];
            if normal != DVec3::ZERO {
                let p = mesh.positions()[*corner as usize];
                let radial = DVec3::new(p.x, p.y, 0.0);
                assert!((normal.normalize() - radial).length() < 1e-12);
                smooth += 1;
            }
        }
    }
    assert_eq!(smooth, 24 * 6);
}

fn material_named<'a>(imported: &'a Imported, name: &str) -> &'a Material {
    let scene = imported.scene.as_ref().expect("valid");
    let material = scene.materials().iter().find(|m| m.name == name);
    material.unwrap_or_else(|| panic!("no material {name}"))
}

fn color(material: &Material) -> Color {
    match material.pigment {
        Pigment::Uniform(color) => color,
        Pigment::Pattern { .. } => panic!("one colour"),
    }
}

#[test]
fn material_libraries_are_found_by_any_kind_of_name() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let text = format!(
        "mtllib first.mtl  two\\ words.mtl C:\\lib\\third.mtl\nmtllib three words here.mtl\n\
         mtllib first.mtl\n{triangle}usemtl red paint \nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\n\
         f 1 2 3\nusemtl d\nf 1 2 3\n"
    );
    let files = [
        ("parts/first.mtl", "newmtl red paint\nKd 1 0 0\n"),
        ("parts/two words.mtl", "newmtl b\nKd 0 1 0\n"),
        ("parts/third.mtl", "newmtl c\nKd 0 0 1\n"),
        ("parts/three words here.mtl", "newmtl d\nKd 0.5\n"),
    ];
    let imported = import_with(&text, &files);
    assert_eq!(messages(&imported), [""; 0]);
    assert_eq!(only_mesh(&imported).materials().expect("four").len(), 4);
    assert_eq!(color(material_named(&imported, "red paint")).rgb, DVec3::X);
    assert_eq!(color(material_named(&imported, "c")).rgb, DVec3::Z);
    assert_eq!(color(material_named(&imported, "d")).rgb, DVec3::splat(0.5));
}

#[test]
fn what_a_library_lacks_is_said_once_and_replaced() {
    let imported = import(
        "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl ghost\nf 1 2 3\nusemtl\nf 1 2 3\n\
         usemtl ghost\nf 1 2 3\n",
    );
    assert_eq!(
        messages(&imported),
        [
            "parts/a.obj:7:1: warning: `usemtl` without a name: the default material is used",
            "parts/a.obj:1:8: warning: the material library `gone.mtl` is not used: there is no \
             such file",
            "parts/a.obj:5:8: warning: no material library defines `ghost`: the default is used",
        ]
    );
    assert!(only_mesh(&imported).materials().is_none());
}

#[test]
fn mtl_numbers_become_materials() {
    let library = "\
        newmtl matte\nKa 0.2 0.2 0.2\nKd 0.5 0.25 0.125\nillum 1\n\
        newmtl shiny\nKd 1 1 1\nKs 0.5 0.5 0.5\nNs 100\nillum 2\n\
        newmtl mirror\nKs 0.8 0.7 0.6\nillum 3\n\
        newmtl glass\nKd 1 1 1\nNi 1.5\nd 1\nillum 7\nmap_Kd wood.png\nbump b.png\n\
        newmtl veil\nKd 1 0 0\nTr 0.25\nillum 2\n\
        newmtl lamp\nKd 0 0 0\nKe 3 2 1\n";
    let mut text = String::from("mtllib m.mtl\n");
    text += &write(&Prism::regular(4, 1.0)).replacen("\nf", "\nusemtl glass\nf", 1);
    let imported = import_with(&text, &[("parts/m.mtl", library)]);
    assert_eq!(
        messages(&imported),
        ["parts/m.mtl:18:1: warning: textures are not read: `glass` is shown without"]
    );
    let of = |name| material_named(&imported, name);
    assert_eq!(color(of("matte")), Color::rgb(0.5, 0.25, 0.125));
    assert_eq!(of("matte").finish.specular, 0.0);
    assert_eq!(of("matte").finish.ambient, DVec3::splat(0.2 * 0.1));
    assert_eq!(
        (of("shiny").finish.specular, of("shiny").finish.roughness),
        (0.5, 0.01)
    );
    assert_eq!(
        of("mirror").finish.reflection.min,
        DVec3::new(0.8, 0.7, 0.6)
    );
    assert!(!of("mirror").finish.reflection.fresnel);
    let glass = of("glass");
    assert!(glass.pigment.is_transparent() && glass.finish.reflection.fresnel);
    assert_eq!(glass.interior.ior, 1.5);
    assert_eq!(
        (color(of("veil")).transmit, of("veil").interior.ior),
        (0.25, 1.0)
    );
    let lamp = of("lamp");
    assert_eq!(
        color(lamp).rgb * lamp.finish.emission,
        DVec3::new(3.0, 2.0, 1.0)
    );
    // A closed mesh of glass has an inside; of anything else it is a sheet.
    let scene = imported.scene.as_ref().expect("valid");
    assert!(matches!(scene.objects()[0].shape, Shape::Solid(_)));
    let opaque = import_with(&text.replace("glass", "shiny"), &[("parts/m.mtl", library)]);
    let scene = opaque.scene.as_ref().expect("valid");
    assert!(matches!(scene.objects()[0].shape, Shape::Sheet(_)));
}

#[test]
fn vertex_colours_become_materials_where_faces_have_one() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 5 0 0 1 0 0 1\nv 6 0 0 1 0 0 1\n\
                v 5 1 0 1 0 0 1\nf 1 2 3\nf 4 5 6\n";
    let imported = import(text);
    let materials = only_mesh(&imported).materials().expect("two colours");
    assert_ne!(materials[0], materials[1]);
    let varied = import(&text.replacen("1 0 0\nv 1", "0 0 1\nv 1", 1));
    assert!(messages(&varied)[0].contains("vary within faces"));
}

#[test]
fn all_mistakes_are_reported_with_line_and_column() {
    let imported = import(
        "v 0 0 0\nv 1 zero 0\nv 0 inf 0\nv 1\nv 1 2 3 4 5\nvn 0 1\nvt\nf 1 2 3\nf 1 2 9\n\
         f 1 0 2\nf 1 2 -7\nf 1 2\nf 1 2 x\nf 1 2 3/\nf 1/2/3/4 2 3\nf 1 2 99999999999999999999\n",
    );
    check_refused(
        &imported,
        &[
            "parts/a.obj:2:5: error: `zero` is not a number",
            "parts/a.obj:3:5: error: `inf` is not finite",
            "parts/a.obj:4:1: error: `v` has 3 numbers, not 1",
            "parts/a.obj:5:1: error: a vertex has 3 coordinates",
            "parts/a.obj:6:1: error: `vn` has 3 numbers, not 2",
            "parts/a.obj:7:1: error: `vt` has 1 numbers, not 0",
            "parts/a.obj:9:7: error: the face uses vertex 9, but there are 5",
            "parts/a.obj:10:5: error: vertex 0 does not exist: counting begins at 1",
            "parts/a.obj:11:7: error: the face uses vertex -7, but only 5 come before it",
            "parts/a.obj:12:1: error: a face has at least 3 corners, this one 2",
            "parts/a.obj:13:7: error: `x` is no corner of a face",
            "parts/a.obj:15:5: error: the face uses texture coordinate 2, but there are 1",
            "parts/a.obj:16:7: error: `99999999999999999999` is no corner of a face",
        ],
    );
}

#[test]
fn what_is_not_a_surface_is_passed_over_with_a_warning() {
    let imported = import("v 0 0 0\nv 1 0 0\np 1\nl 1 2\nl 1 2\ncstype bezier\nblub\n");
    assert_eq!(
        messages(&imported),
        [
            "parts/a.obj:3:1: warning: `p` is passed over: points and lines have no surface",
            "parts/a.obj:4:1: warning: `l` is passed over: points and lines have no surface",
            "parts/a.obj:6:1: warning: `cstype` is passed over: free-form curves and surfaces \
             are not read",
            "parts/a.obj:7:1: warning: `blub` is passed over: it is no statement of OBJ",
            "parts/a.obj: warning: the file holds no faces",
        ]
    );
    assert!(imported.scene.is_some());
}

#[test]
fn other_encodings_are_refused_by_name() {
    for (bytes, name) in [
        (&b"\xff\xfev\0"[..], "UTF-16"),
        (b"\xfe\xff\0v", "UTF-16"),
        (b"\xff\xfe\0\0v\0\0\0", "UTF-32"),
        (b"v 0 0 0\n\0\0", "binary data"),
    ] {
        let files = InMemory::default();
        let imported = obj::import(
            Path::new("a.obj"),
            bytes.to_vec(),
            &files,
            &Options::default(),
        );
        check_refused(&imported, &[&format!("a.obj: error: the file is {name}")]);
    }
}

//! The example of a scene file in the README is a scene that works and names every field.

use std::path::Path;

use whitted_cli::inspect::inspect;
use whitted_cli::scene::{HostScene, Pool};
use whitted_cli::scene_file::toml;

/// The README's section on scene files.
fn section() -> &'static str {
    const README: &str = include_str!("../../README.md");
    &README[README.find("\n## Scene files\n").unwrap()..]
}

fn example() -> &'static str {
    let start = section().find("```toml\n").unwrap() + "```toml\n".len();
    let length = section()[start..].find("```").unwrap();
    &section()[start..start + length]
}

#[test]
fn the_example_renders_without_a_warning() {
    let file = toml::parse(Path::new("example.toml"), example()).unwrap();
    let pool = Pool::new(&file);
    let scene = HostScene::new(&file, &pool).unwrap();
    assert!(scene.camera(640, 480).unwrap().is_some());
    assert_eq!(inspect(&scene, &pool).warnings, []);
}

#[test]
fn the_example_has_every_field_of_the_tables() {
    let reference = &section()[..section().find("### Example").unwrap()];
    let mut fields = 0;
    for row in reference.lines().filter(|it| it.starts_with("| ")) {
        // Field names stand in the first column, those of shapes in the second.
        let cells: Vec<_> = row.split('|').collect();
        for name in cells[1..3]
            .iter()
            .flat_map(|it| it.split('`').skip(1).step_by(2))
        {
            let word = name.trim_matches(|it: char| !it.is_ascii_lowercase());
            // Defaults stand in the second column too.
            if word.len() == name.len() && name != "true" {
                assert!(example().contains(&format!("{name} = ")), "{name}");
                fields += 1;
            } else if name.starts_with("[[") {
                assert!(example().contains(name), "{name}");
                fields += 1;
            }
        }
    }
    assert!(fields > 40, "{fields} fields found");
}

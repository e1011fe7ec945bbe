//! The command line.

use std::path::PathBuf;

use crate::meshes;
use crate::rays::Kind;

pub const USAGE: &str = "\
octray's triangles against Embree's, chunk by chunk in one process.

usage: octray-embree [options]

  --mesh NAME,...       of the meshes below (default: all)
  --kind NAME,...       primary, diffuse, shadow (default: all)
  --only TEXT,...       contenders whose name holds one of the texts, as in the table
                        (octray/slice, octray/one, octray/tree, embree3/high/8-coherent, ...)
  --size N              pixels along a side, a power of two up to 4096 (default: 1024)
  --repetitions N       times that every chunk is given to everyone (default: 4)
  --builds N            times that every structure is built (default: 1)
  --threads N           threads to build with; rays are traced by one (default: 1)
  --library PATH        an Embree to load beside those that are found; may stand repeatedly
  --json PATH           writes the figures there too
  --ply FOLDER          writes the meshes there as PLY files and measures nothing

meshes:
";

/// What was asked for.
#[derive(Clone, Debug)]
pub struct Options {
    pub meshes: Vec<String>,
    pub kinds: Vec<Kind>,
    pub only: Vec<String>,
    pub size: u32,
    pub repetitions: u32,
    pub builds: u32,
    pub threads: usize,
    pub libraries: Vec<PathBuf>,
    pub json: Option<PathBuf>,
    pub ply: Option<PathBuf>,
}

/// Reads the arguments; what is to be said instead of measuring, and whether it is an error.
pub fn read(mut arguments: impl Iterator<Item = String>) -> Result<Options, (String, bool)> {
    let wrong = |message: String| (message, true);
    let mut options = Options {
        meshes: meshes::NAMES.map(|(name, _)| name.to_owned()).into(),
        kinds: Kind::ALL.into(),
        only: Vec::new(),
        size: 1024,
        repetitions: 4,
        builds: 1,
        threads: 1,
        libraries: Vec::new(),
        json: None,
        ply: None,
    };
    while let Some(argument) = arguments.next() {
        if matches!(argument.as_str(), "-h" | "--help") {
            return Err((usage(), false));
        }
        let value = arguments.next();
        let value = value.ok_or_else(|| wrong(format!("{argument} needs a value")))?;
        let list = || value.split(',').map(str::to_owned).collect::<Vec<_>>();
        let number = |most: u32| match value.parse() {
            Ok(number @ 1..) if number <= most => Ok(number),
            _ => Err(wrong(format!(
                "{argument} is a number from 1 to {most}, not `{value}`"
            ))),
        };
        match argument.as_str() {
            "--mesh" => {
                let known = |name: &str| meshes::NAMES.iter().any(|(known, _)| *known == name);
                options.meshes = list();
                if let Some(name) = options.meshes.iter().find(|name| !known(name)) {
                    return Err(wrong(format!("there is no mesh `{name}`; see --help")));
                }
            }
            "--kind" => {
                let kind = |name: String| {
                    let found = Kind::ALL.into_iter().find(|kind| kind.name() == name);
                    found.ok_or_else(|| wrong(format!("there is no kind of rays `{name}`")))
                };
                options.kinds = list().into_iter().map(kind).collect::<Result<_, _>>()?;
            }
            "--only" => options.only = list(),
            "--size" => {
                options.size = number(4096)?;
                if !options.size.is_power_of_two() {
                    return Err(wrong("--size is a power of two".to_owned()));
                }
            }
            "--repetitions" => options.repetitions = number(1000)?,
            "--builds" => options.builds = number(1000)?,
            "--threads" => options.threads = number(1024)? as usize,
            "--library" => options.libraries.push(value.into()),
            "--json" => options.json = Some(value.into()),
            "--ply" => options.ply = Some(value.into()),
            _ => return Err(wrong(format!("there is no option {argument}; see --help"))),
        }
    }
    Ok(options)
}

fn usage() -> String {
    let mesh = |(name, what): &(&str, &str)| format!("  {name:10} {what}\n");
    USAGE.to_owned() + &meshes::NAMES.iter().map(mesh).collect::<String>()
}

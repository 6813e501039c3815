//! The window under Xvfb with a software driver: it opens, shows a scene, reacts to the mouse, writes pictures.
//!
//! Ignored by default: `cargo xtask ci --full` runs it. Without Xvfb, xdotool or a driver the test reports that it was
//! skipped.
#![cfg(feature = "viewer")]

use crate::sinew::{Folder, Run, command, sinew};
use sinew::formats::read_ragdoll;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Timeout for a software driver on a busy machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// A separate display, killed at the end.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts a display; `None` without Xvfb or xdotool.
    fn start() -> Option<Self> {
        let has = |program: &str| {
            let found =
                Command::new(program).arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            found.is_ok()
        };
        if !has("xdotool") {
            println!("skipped: no xdotool here (Debian's package `xdotool`)");
            return None;
        }
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1400x900x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut server) = server else {
            println!("skipped: no Xvfb here (Debian's package `xvfb`)");
            return None;
        };
        let mut number = String::new();
        let out = server.stdout.as_mut().expect("stdout is piped");
        BufReader::new(out.take(16)).read_line(&mut number).expect("Xvfb prints the display number");
        Some(Self { server, name: format!(":{}", number.trim()) })
    }

    fn xdotool(&self, arguments: &[&str]) {
        let done = Command::new("xdotool").args(arguments).env("DISPLAY", &self.name).output();
        let done = done.expect("xdotool starts");
        assert!(done.status.success(), "xdotool {arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // The server may have ended already.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The viewer process and its output, killed at the end.
struct Viewer {
    process: Child,
    lines: Receiver<String>,
}

impl Viewer {
    fn start(display: &Display, folder: &Folder, arguments: &[&str]) -> Self {
        let mut command = command(arguments);
        let mut process = command
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_CONFIG_HOME", folder.path("config"))
            .current_dir(folder.path(""))
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        let stderr = BufReader::new(process.stderr.take().expect("stderr is piped"));
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in stderr.lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
        Self { process, lines }
    }

    /// Waits for the next line that contains these words.
    fn wait_for(&self, words: &str) -> String {
        let mut lines_read = Vec::new();
        loop {
            let line = self.lines.recv_timeout(PATIENCE);
            let line = line.unwrap_or_else(|_| panic!("no line has `{words}`, but {lines_read:#?}"));
            if line.contains(words) {
                return line;
            }
            lines_read.push(line);
        }
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
#[ignore = "opens a window: cargo xtask ci --full"]
fn window_opens_and_the_mouse_pulls_a_body() {
    let Some(display) = Display::start() else { return };
    if let Err(error) = sinew_viewer::Gpu::open() {
        return println!("skipped: {error}");
    }
    let folder = Folder::new("window");
    let viewer = Viewer::start(&display, &folder, &["view", "free_fall", "--paused", "--log"]);
    viewer.wait_for("drawn by");
    // Without a window manager, the focus must be set explicitly.
    display.xdotool(&["search", "--name", "Sinew", "windowfocus"]);
    display.xdotool(&["mousemove", "620", "357"]);
    let picture = || {
        display.xdotool(&["key", "F12"]);
        let line = viewer.wait_for("wrote");
        let name = line.strip_prefix("wrote ").expect("the name follows").to_owned();
        let bytes = std::fs::read(folder.path(&name)).expect("the picture exists");
        assert!(bytes.starts_with(b"\x89PNG"));
        (name, bytes)
    };
    let (name, before) = picture();
    assert_eq!(name, "sinew-free_fall-0.png");
    // For a single falling body, the picture is centred on the body.
    display.xdotool(&["mousedown", "1"]);
    display.xdotool(&["mousemove", "632", "350"]);
    viewer.wait_for("holds body");
    // Key presses within one frame of a slow driver merge, so fewer steps may be taken.
    for i in 1..=12 {
        let (x, y) = ((620 + 14 * i).to_string(), (357 - 8 * i).to_string());
        display.xdotool(&["mousemove", &x, &y, "key", "n"]);
    }
    display.xdotool(&["mouseup", "1"]);
    viewer.wait_for("let go");
    let (name, after) = picture();
    assert_ne!(name, "sinew-free_fall-0.png", "no step was taken");
    assert_ne!(before, after, "the click had no effect");
}

/// Reads the written ragdoll and returns the largest swing about z of its left upper arm, degrees.
fn swing(path: &str) -> f32 {
    let def =
        read_ragdoll(&std::fs::read(path).expect("the file can be read")).expect("the file is a ragdoll");
    let arm =
        def.bodies.iter().position(|body| body.role == "leftUpperArm").expect("the ragdoll has this body");
    let joint = def.joints.iter().find(|joint| joint.child == arm).expect("the arm has a joint");
    let [_, Some(z), _] = sinew_viewer::limits(&joint.kind) else {
        panic!("the arm's joint has a swing limit")
    };
    z.hi.to_degrees()
}

/// Opens a character, pulls a bone, narrows a limit by keys, and checks the saved file.
#[test]
#[ignore = "opens a window: cargo xtask ci --full"]
fn edited_limit_is_saved() {
    let Some(display) = Display::start() else { return };
    if let Err(error) = sinew_viewer::Gpu::open() {
        return println!("skipped: {error}");
    }
    let folder = Folder::new("window-edit");
    let file = folder.mannequin();
    let built = folder.path("built.sinew.json");
    sinew(&["ragdoll", "build", &file, "-o", &built, "--json"]).json();
    let viewer = Viewer::start(&display, &folder, &["view", &file, "--paused", "--log"]);
    viewer.wait_for("drawn by");
    display.xdotool(&["search", "--name", "Sinew", "windowfocus"]);
    display.xdotool(&["mousemove", "620", "400"]);
    display.xdotool(&["key", "F12"]);
    let first = viewer.wait_for("wrote sinew-");
    // Presses the key until the arm is selected; a humanoid has fewer bodies than presses.
    let chosen = (0..30).any(|_| {
        display.xdotool(&["key", "bracketright"]);
        viewer.wait_for("chose ").starts_with("chose leftUpperArm ")
    });
    assert!(chosen, "the character has a left upper arm");
    let mut output_text = String::new();
    for _ in 0..4 {
        display.xdotool(&["key", "minus"]);
        output_text = viewer.wait_for("limits of leftUpperArm: ");
    }
    display.xdotool(&["key", "ctrl+s"]);
    let line = viewer.wait_for(".sinew.json");
    let name = line.strip_prefix("wrote ").expect("the name follows").to_owned();
    let (before, after) = (swing(&built), swing(&folder.path(&name)));
    assert!((before - after - 20.0).abs() < 0.1, "range {before}° became {after}°; log: {output_text}");
    display.xdotool(&["key", "F12"]);
    assert_eq!(viewer.wait_for("wrote sinew-"), first, "the test restarts at step 0");
    // The ragdoll falls with the new limits, and the written file can be opened.
    for _ in 0..5 {
        display.xdotool(&["key", "n"]);
    }
    drop(viewer);
    let viewer = Viewer::start(&display, &folder, &["view", &folder.path(&name), "--paused", "--log"]);
    viewer.wait_for("drawn by");
}

/// A single command writes a picture of the window with its panels, and exits.
#[test]
#[ignore = "opens a window: cargo xtask ci --full"]
fn one_command_writes_a_picture_of_the_window() {
    let Some(display) = Display::start() else { return };
    if let Err(error) = sinew_viewer::Gpu::open() {
        return println!("skipped: {error}");
    }
    let folder = Folder::new("window-picture");
    let run = |out: &str| {
        let mut command = command(&["view", "ragdoll_drop", "--screenshot", out, "--at", "0.5"]);
        Run::of(command.env("DISPLAY", &display.name).env("XDG_CONFIG_HOME", folder.path("config")))
    };
    let out = folder.path("window.png");
    let output_text = run(&out);
    assert_eq!(output_text.code, Some(0), "{output_text:?}");
    assert!(std::fs::read(&out).expect("the file can be read").starts_with(b"\x89PNG"));
    let refused = run(&folder.path("nowhere/window.png"));
    // Libraries of the system may print lines before.
    let line = refused.stderr.lines().last().expect("there is a line on stderr");
    assert!(
        refused.code == Some(1) && line.starts_with("error: ") && line.contains("nowhere"),
        "{refused:?}"
    );
}

#[test]
#[ignore = "opens a display: cargo xtask ci --full"]
fn invalid_file_is_reported_in_one_line() {
    let Some(display) = Display::start() else { return };
    let folder = Folder::new("window-file");
    let file = folder.file("no.glb", "nothing");
    let viewer = Viewer::start(&display, &folder, &["view", &file, "--log"]);
    let line = viewer.wait_for("no.glb");
    assert!(line.starts_with("error: "), "{line}");
}

//! The files of the page, which are part of the program.

/// A file, its media type and its text.
pub(crate) struct PageFile {
    pub path: &'static str,
    pub media_type: &'static str,
    pub text: &'static str,
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! file {
    ($path:literal, $media_type:expr) => {
        PageFile {
            path: concat!("/", $path),
            media_type: $media_type,
            text: include_str!(concat!("page/", $path)),
        }
    };
}

pub(crate) const INDEX: PageFile = PageFile {
    path: "/",
    media_type: HTML,
    text: include_str!("page/index.html"),
};

/// All of them.
pub(crate) const FILES: [PageFile; 10] = [
    INDEX,
    file!("style.css", CSS),
    file!("main.js", SCRIPT),
    file!("run.js", SCRIPT),
    file!("plot.js", SCRIPT),
    file!("object.js", SCRIPT),
    file!("forces.js", SCRIPT),
    file!("course.js", SCRIPT),
    file!("timing.js", SCRIPT),
    file!("link.js", SCRIPT),
];

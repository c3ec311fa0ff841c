//! The program `brdf`: everything is in the library.

fn main() -> std::process::ExitCode {
    brdf_host::cli::run()
}

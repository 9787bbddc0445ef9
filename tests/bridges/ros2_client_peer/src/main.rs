//! Clients made with ros2-client, in one program, because each program of it takes long to build.
//! Arguments: `cart` or `grip`, the domain, and how a response names its request.
mod cart;
mod grip;
mod waiting;

use ros2_client::ServiceMapping;

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let domain = words[2].parse().unwrap();
    let mapping = match words[3].as_str() {
        "enhanced" => ServiceMapping::Enhanced,
        _ => ServiceMapping::Cyclone,
    };
    match words[1].as_str() {
        "cart" => cart::run(domain, mapping),
        "grip" => grip::run(domain, mapping),
        other => panic!("no client is named {other}"),
    }
    std::process::exit(0);
}

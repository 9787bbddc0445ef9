//! A node made with ros2-client, on RustDDS: reads the simulation, drives the cart, calls services.
//! Prints one line for each thing that it has seen; the test judges.
use crate::waiting::{self, pause, within};
use futures::executor::block_on;
use ros2_client::{
    Context, ContextOptions, Message, MessageTypeName, Name, NodeName, NodeOptions, QosProfile, ServiceMapping,
    ServiceTypeName,
};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Time {
    sec: i32,
    nanosec: u32,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Header {
    stamp: Time,
    frame_id: String,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Vector3 {
    x: f64,
    y: f64,
    z: f64,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Pose {
    position: Vector3,
    orientation: Quaternion,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Twist {
    linear: Vector3,
    angular: Vector3,
}
/// The beginning of nav_msgs/Odometry, which is all that is looked at.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Odometry {
    header: Header,
    child_frame_id: String,
    pose: Pose,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Image {
    header: Header,
    height: u32,
    width: u32,
    encoding: String,
    is_bigendian: u8,
    step: u32,
    data: Vec<u8>,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct TransformStamped {
    header: Header,
    child_frame_id: String,
    translation: Vector3,
    rotation: Quaternion,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct TfMessage {
    transforms: Vec<TransformStamped>,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Clock {
    clock: Time,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Empty {
    structure_needs_at_least_one_member: u8,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SpawnRequest {
    name: String,
    xml: String,
    robot_namespace: String,
    initial_pose: Pose,
    reference_frame: String,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct SpawnResponse {
    success: bool,
    status_message: String,
}
impl Message for Odometry {}
impl Message for Image {}
impl Message for TfMessage {}
impl Message for Clock {}
impl Message for Twist {}
impl Message for Empty {}
impl Message for SpawnRequest {}
impl Message for SpawnResponse {}

const BOX: &str = r#"<robot name="crate"><link name="body">
  <inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>"#;

/// Waiting messages, at most a hundred: on a busy computer they can come faster than they are taken.
fn taken<T, E>(mut take: impl FnMut() -> Result<Option<T>, E>) -> Vec<T> {
    std::iter::from_fn(|| take().ok().flatten()).take(100).collect()
}

pub fn run(domain: u16, mapping: ServiceMapping) {
    let context = Context::with_options(ContextOptions::new().domain_id(domain)).unwrap();
    let mut node = context.new_node(NodeName::new("/", "peer").unwrap(), NodeOptions::new()).unwrap();
    waiting::spawn(node.spinner().unwrap().spin());
    let qos = QosProfile::publisher_default();
    macro_rules! subscribe {
        ($space:literal, $name:literal, $package:literal, $type:literal, $struct:ty, $qos:expr) => {{
            let name = Name::new($space, $name).unwrap();
            let topic = node.create_topic(&name, MessageTypeName::new($package, $type), $qos).unwrap();
            node.create_subscription::<$struct>(&topic, None).unwrap()
        }};
    }
    let sensor = QosProfile::subscription_default();
    let odometry = subscribe!("/", "odom", "nav_msgs", "Odometry", Odometry, &qos);
    let transforms = subscribe!("/", "tf", "tf2_msgs", "TFMessage", TfMessage, &qos);
    let clocks = subscribe!("/", "clock", "rosgraph_msgs", "Clock", Clock, &qos);
    let images = subscribe!("/rosbots/camera1", "image_raw", "sensor_msgs", "Image", Image, &sensor);
    let command = Name::new("/part2_cmr", "cmd_vel").unwrap();
    let topic = node.create_topic(&command, MessageTypeName::new("geometry_msgs", "Twist"), &qos).unwrap();
    let commands = node.create_publisher::<Twist>(&topic, None).unwrap();
    let spawn = node
        .create_client::<SpawnRequest, SpawnResponse>(
            mapping,
            &Name::new("/", "spawn_entity").unwrap(),
            &ServiceTypeName::new("gazebo_msgs", "SpawnEntity"),
            qos.clone(),
            qos.clone(),
        )
        .unwrap();
    let reset = node
        .create_client::<Empty, Empty>(
            mapping,
            &Name::new("/", "reset_simulation").unwrap(),
            &ServiceTypeName::new("std_srvs", "Empty"),
            qos.clone(),
            qos.clone(),
        )
        .unwrap();
    block_on(async {
        // A call before both sides know each other is lost in ROS 2.
        pause(Duration::from_secs(4)).await;
        let zero = || Vector3 { x: 0., y: 0., z: 0. };
        let request = SpawnRequest {
            name: "crate".into(),
            xml: BOX.into(),
            robot_namespace: "".into(),
            initial_pose: Pose {
                position: Vector3 { x: 0., y: 5., z: 0.1 },
                orientation: Quaternion { x: 0., y: 0., z: 0., w: 1. },
            },
            reference_frame: "".into(),
        };
        match within(20, spawn.async_call_service(request)).await {
            Some(Ok(answer)) => println!("spawn {} {}", answer.success, answer.status_message),
            other => println!("spawn failed {other:?}"),
        }
        // As long as it takes: two seconds of odometry where the computer is not busy.
        let end = Instant::now() + Duration::from_secs(240);
        let (mut n, mut x, mut frame) = ([0u32; 4], 0f64, String::new());
        let mut size = (0, 0, 0);
        while Instant::now() < end && (n[..3].iter().any(|&n| n <= 200) || n[3] <= 20 || x <= 0.5) {
            commands.publish(Twist { linear: Vector3 { x: 0.5, ..zero() }, angular: zero() }).unwrap();
            for (message, _) in taken(|| odometry.take()) {
                n[0] += 1;
                x = message.pose.position.x;
            }
            for (message, _) in taken(|| transforms.take()) {
                n[1] += 1;
                if let Some(one) = message.transforms.iter().find(|one| one.header.frame_id == "odom") {
                    frame = one.child_frame_id.clone();
                }
            }
            for _ in taken(|| clocks.take()) {
                n[2] += 1;
            }
            for (message, _) in taken(|| images.take()) {
                n[3] += 1;
                size = (message.width, message.height, message.data.len());
            }
            pause(Duration::from_millis(10)).await;
        }
        println!("odometry {} {:.3}", n[0], x);
        println!("tf {} {}", n[1], frame);
        println!("clock {}", n[2]);
        println!("images {} {} {} {}", n[3], size.0, size.1, size.2);
        let empty = Empty { structure_needs_at_least_one_member: 0 };
        match within(20, reset.async_call_service(empty)).await {
            Some(Ok(_)) => println!("reset true"),
            other => println!("reset failed {other:?}"),
        }
    });
}

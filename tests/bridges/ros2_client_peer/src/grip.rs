//! A client of an action, made with ros2-client: sends a goal to a gripper and waits for its end, then
//! sends another and cancels it. Prints one line for each thing that it has seen; the test judges.
use crate::waiting::{self, pause, within};
use futures::{executor::block_on, StreamExt};
use ros2_client::{
    action::ActionClientQosPolicies, builtin_interfaces::Time, ActionTypeName, Context, ContextOptions, Message,
    Name, NodeName, NodeOptions, QosProfile, ServiceMapping,
};
use serde::{Deserialize, Serialize};
use std::time::Duration;

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Goal {
    position: f64,
    max_effort: f64,
}
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Outcome {
    position: f64,
    effort: f64,
    stalled: bool,
    reached_goal: bool,
}
impl Message for Goal {}
impl Message for Outcome {}

pub fn run(domain: u16, mapping: ServiceMapping) {
    let context = Context::with_options(ContextOptions::new().domain_id(domain)).unwrap();
    let mut node = context.new_node(NodeName::new("/", "hand_client").unwrap(), NodeOptions::new()).unwrap();
    waiting::spawn(node.spinner().unwrap().spin());
    let qos = QosProfile::publisher_default();
    let client = node
        .create_action_client::<Goal, Outcome, Outcome>(
            mapping,
            &Name::new("/gripper", "gripper_cmd").unwrap(),
            &ActionTypeName::new("control_msgs", "GripperCommand"),
            ActionClientQosPolicies {
                goal_service: qos.clone(),
                result_service: qos.clone(),
                cancel_service: qos.clone(),
                feedback_subscription: qos.clone(),
                status_subscription: qos.clone(),
            },
        )
        .unwrap();
    block_on(async {
        // A call before both sides know each other is lost in ROS 2.
        pause(Duration::from_secs(4)).await;
        let sent = within(20, client.async_send_goal(Goal { position: 0.3, max_effort: 0.0 })).await;
        let Some(Ok((id, answer))) = sent else {
            println!("goal failed {sent:?}");
            return;
        };
        println!("goal {}", answer.accepted);
        let mut feedback = Box::pin(client.feedback_stream(id));
        let mut count = 0;
        let mut result = Box::pin(client.async_request_result(id));
        let ended = within(40, async {
            loop {
                match futures::future::select(feedback.next(), &mut result).await {
                    futures::future::Either::Left((Some(Ok(_)), _)) => count += 1,
                    futures::future::Either::Left((other, _)) => println!("feedback failed {other:?}"),
                    futures::future::Either::Right((ended, _)) => break ended,
                }
            }
        })
        .await;
        match ended {
            Some(Ok((status, outcome))) => println!("result {status:?} {:.2} {}", outcome.position, outcome.reached_goal),
            other => println!("result failed {other:?}"),
        }
        println!("feedback {count}");
        let sent = within(20, client.async_send_goal(Goal { position: 2.5, max_effort: 0.0 })).await;
        let Some(Ok((id, _))) = sent else {
            println!("second failed {sent:?}");
            return;
        };
        match within(20, client.async_cancel_goal(id, Time::ZERO)).await {
            Some(Ok(_)) => println!("cancel true"),
            other => println!("cancel failed {other:?}"),
        }
        match within(20, client.async_request_result(id)).await {
            Some(Ok((status, _))) => println!("second {status:?}"),
            other => println!("second failed {other:?}"),
        }
    });
}

//! Frames: the tree that transforms make of them, and the pose of the robot in it.
//!
//! Localisation publishes what it finds as the transform of a map to an odometry's frame, below which the odometry publishes
//! the robot: the robot's pose in the map follows from both. Between two corrections by the localisation it moves as the
//! odometry says, which most drivers make of the wheels: it is a measurement where it was corrected, and nowhere else.

use grouser_real::Real;
use grouser_slip::Measurement;

use super::choose::{has_word, is_of_wheels, is_over_ground};
use super::mounting::turned;
use crate::message::{Elements, Transform};

/// Frames that are kept.
const MAX_FRAMES: usize = 4096;
/// A longer chain of transforms is a circle.
pub(super) const MAX_CHAIN: usize = 64;
/// The robot's base by REP 105, the best first.
const BASES: [&str; 3] = ["base_link", "base_footprint", "base"];

/// A frame in its parent.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    frame: String,
    pub(super) parent: String,
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
    /// Was it sent as one that never changes?
    pub(super) is_static: bool,
    has_changed: bool,
    /// Is the parent the frame of an odometry, which may be made of the wheels?
    is_on_odometry: bool,
}

/// The frames of a tree, by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree(Vec<Link>);

impl Tree {
    fn find(&self, frame: &str) -> Result<usize, usize> {
        self.0
            .binary_search_by(|link| link.frame.as_str().cmp(frame))
    }

    pub(super) fn get(&self, frame: &str) -> Option<&Link> {
        Some(&self.0[self.find(frame).ok()?])
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The link of a frame, which `make` makes where the tree has none and fewer than [`MAX_FRAMES`]; `None` where it has not.
    fn entry(&mut self, frame: &str, make: &dyn Fn() -> Link) -> Option<&mut Link> {
        let place = self.find(frame);
        if let Err(place) = place
            && self.0.len() < MAX_FRAMES
        {
            self.0.insert(place, make());
        }
        place.ok().map(|place| &mut self.0[place])
    }
}

impl Link {
    fn new(transform: &Transform, is_static: bool) -> Self {
        let parent = plain(transform.frame);
        Self {
            is_on_odometry: is_of_wheels(parent),
            frame: plain(transform.child_frame).to_owned(),
            parent: parent.to_owned(),
            translation: transform.translation,
            rotation: transform.rotation,
            is_static,
            has_changed: false,
        }
    }
}

/// The first transform of each frame by each topic.
#[derive(Clone, Debug, Default)]
pub(crate) struct FirstTransforms {
    by_topic: Vec<Tree>,
    count: usize,
}

impl FirstTransforms {
    /// Enters a transform of a topic, if its frame is new.
    pub(crate) fn enter(&mut self, topic: usize, transform: &Transform, is_static: bool) {
        if self.by_topic.len() <= topic {
            self.by_topic.resize_with(topic + 1, Tree::default);
        }
        if self.count < MAX_FRAMES {
            let make = || Link::new(transform, is_static);
            let known = self.by_topic[topic].entry(plain(transform.child_frame), &make);
            self.count += usize::from(known.is_none());
        }
    }

    /// The tree by the topics that `of` takes.
    pub(crate) fn tree(&self, of: impl Fn(usize) -> bool) -> Tree {
        let mut tree = Tree::default();
        for (topic, own) in self.by_topic.iter().enumerate() {
            if of(topic) {
                for link in &own.0 {
                    tree.entry(&link.frame, &|| link.clone());
                }
            }
        }
        tree
    }
}

/// Does a topic of that name hold transforms that never change?
pub(crate) fn is_static(topic: &str) -> bool {
    topic.ends_with("static")
}

/// ROS 1 writes frames with a slash in front.
pub(super) fn plain(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

fn last_part(frame: &str) -> &str {
    frame.rsplit('/').next().unwrap_or(frame)
}

pub(super) fn is_base(frame: &str) -> bool {
    BASES.contains(&last_part(frame))
}

/// Is it a frame that is fixed to the ground by its name?
fn is_map(frame: &str) -> bool {
    has_word(frame, &["map", "world"])
}

/// The links from a frame upwards, to `top` or to the root of the tree.
fn chain<'t>(
    tree: &'t Tree,
    frame: &'t str,
    top: Option<&'t str>,
) -> impl Iterator<Item = &'t Link> {
    let mut frame = frame;
    std::iter::from_fn(move || {
        if Some(frame) == top {
            return None;
        }
        let link = tree.get(frame)?;
        frame = &link.parent;
        Some(link)
    })
    .take(MAX_CHAIN)
}

/// The robot's frame, and the one in which transforms hold its pose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FramePair {
    pub(crate) fixed: String,
    pub(crate) base: String,
    /// Is the first fixed to the ground by its name?
    pub(crate) is_absolute: bool,
}

/// The poses that a tree holds: of `base`, else of every robot's base, else of what a tracker follows; in `fixed`, else in the
/// nearest map, and where there is none in the root of the tree.
pub(crate) fn poses(tree: &Tree, fixed: Option<&str>, base: Option<&str>) -> Vec<FramePair> {
    let fixed = fixed.map(plain);
    let pair = |base: &str| {
        let (mut top, mut moves, mut length) = (base, false, 0);
        for link in chain(tree, base, fixed) {
            (top, moves, length) = (&link.parent, moves || !link.is_static, length + 1);
            if fixed.is_none() && is_map(top) {
                break;
            }
        }
        let is_led = fixed.is_none_or(|fixed| fixed == top);
        (is_led && moves && length < MAX_CHAIN).then(|| FramePair {
            fixed: top.to_owned(),
            base: base.to_owned(),
            is_absolute: is_map(top) || is_over_ground(top),
        })
    };
    if let Some(base) = base {
        return pair(plain(base)).into_iter().collect();
    }
    let mut found: Vec<FramePair> = Vec::new();
    for name in BASES {
        for link in tree.0.iter().filter(|link| last_part(&link.frame) == name) {
            let mut others = found.iter();
            if !others.any(|other| prefix(&other.base) == prefix(&link.frame)) {
                found.extend(pair(&link.frame));
            }
        }
    }
    let is_absolute = |pair: &FramePair| pair.is_absolute;
    if !found.iter().any(is_absolute) {
        for link in tree.0.iter().filter(|link| !link.is_static) {
            let (body, fixed) = (&link.frame, &link.parent);
            if is_over_ground(fixed) || (is_map(fixed) && is_over_ground(body)) {
                found.extend(pair(body));
            }
        }
    }
    if found.iter().any(is_absolute) {
        found.retain(is_absolute);
    }
    found
}

/// The namespace of a frame.
pub(super) fn prefix(frame: &str) -> &str {
    frame.rsplit_once('/').map_or("", |(prefix, _)| prefix)
}

/// Follows the pose of a frame by the transforms that lead to it.
#[derive(Clone, Debug)]
pub(crate) struct FramePose {
    tree: Tree,
    pair: FramePair,
    /// Has something above the odometry changed since the last pose, or the chain of frames?
    is_corrected: bool,
}

impl FramePose {
    /// Of a tree, whose links that never change are kept.
    pub(super) fn new(mut tree: Tree, pair: FramePair) -> Self {
        tree.0.retain(|link| link.is_static);
        Self {
            tree,
            pair,
            is_corrected: false,
        }
    }

    /// Enters a transform; is it new, or another than before?
    fn put(&mut self, transform: &Transform, is_static: bool) -> bool {
        let child = plain(transform.child_frame);
        let make = || Link::new(transform, is_static);
        let Some(link) = self.tree.entry(child, &make) else {
            return true;
        };
        let parent = plain(transform.frame);
        let is_same = link.parent == parent
            && (link.translation, link.rotation) == (transform.translation, transform.rotation);
        if !is_same {
            if link.parent != parent {
                parent.clone_into(&mut link.parent);
                link.is_on_odometry = is_of_wheels(parent);
                self.is_corrected = true;
            }
            (link.translation, link.rotation) = (transform.translation, transform.rotation);
            (link.is_static, link.has_changed) = (is_static, true);
        }
        !is_same
    }

    fn chain(&self) -> impl Iterator<Item = &Link> {
        chain(&self.tree, &self.pair.base, Some(&self.pair.fixed))
    }

    /// Takes the transforms of a message; gives the poses that they make, with their stamps.
    pub(super) fn follow<'a>(
        &'a mut self,
        all: &Elements<'a, Transform<'a>>,
        is_static: bool,
    ) -> impl Iterator<Item = (Option<i64>, Measurement)> + use<'a> {
        all.iter()
            .filter_map(move |one| Some((one.stamp_ns, self.take(&one, is_static)?)))
    }

    /// Takes a transform; gives the pose where it is the one that moves the robot, the lowest that changes. Others count from
    /// then on, as they are known last. Below an odometry's frame the pose is given where it was corrected.
    fn take(&mut self, transform: &Transform, is_static: bool) -> Option<Measurement> {
        let is_new = self.put(transform, is_static);
        let child = plain(transform.child_frame);
        let (mut place, mut odometry, mut changing, mut moving) = (None, None, None, None);
        for (index, link) in self.chain().enumerate() {
            if link.frame == child {
                place = Some(index);
            }
            // a fixed frame that is an odometry's was named
            if link.is_on_odometry && link.parent != self.pair.fixed {
                odometry = Some(index);
            }
            changing = changing.or(link.has_changed.then_some(index));
            moving = moving.or((!link.is_static).then_some(index));
        }
        self.is_corrected |= is_new && odometry.is_some() && place > odometry;
        let moves = place.is_some() && place == changing.or(moving);
        if !moves || (odometry.is_some() && !self.is_corrected) {
            return None;
        }
        let pose = self.pose()?;
        self.is_corrected = false;
        Some(pose)
    }

    /// The pose by the transforms that are known last; `None` where they do not lead to it.
    fn pose(&self) -> Option<Measurement> {
        let (mut place, mut ahead, mut top) = ([0.0; 3], [1.0, 0.0, 0.0], self.pair.base.as_str());
        for link in self.chain() {
            place = turned(link.rotation, place)?;
            for (place, way) in place.iter_mut().zip(link.translation) {
                *place += way;
            }
            ahead = turned(link.rotation, ahead)?;
            top = &link.parent;
        }
        (top == self.pair.fixed).then(|| Measurement::Pose {
            x: place[0],
            y: place[1],
            yaw: Real::atan2(ahead[1], ahead[0]),
        })
    }

    /// What it measures, in words.
    pub(super) fn words(&self) -> String {
        let FramePair { fixed, base, .. } = &self.pair;
        format!("pose of `{base}` in `{fixed}`")
    }
}

#[cfg(test)]
mod tests;

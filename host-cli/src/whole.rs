//! All of a scene: its objects, its solids, and the groups that it places.

use whitted::csg::{Crossed, Expression};
use whitted::math::Passage;
use whitted::{
    Candidates, Closed, Csg, Cuboid, Finish, Geometry, Instance, Math, Object, Placement, Plane,
    Quadric, Ray, Shape, Side, Sphere, Torus, Vec3,
};

use crate::scene::Material;
use crate::scene_file::{Step, limits};

/// A closed shape of any kind.
#[derive(Clone, Copy, Debug)]
pub enum Leaf<'a> {
    /// A ball.
    Sphere(Object<'a, Sphere, Material>),
    /// What lies behind a plane.
    Plane(Object<'a, Plane, Material>),
    /// A box.
    Cuboid(Object<'a, Cuboid, Material>),
    /// A closed quadric.
    Quadric(Object<'a, Quadric, Material>),
    /// A torus.
    Torus(Object<'a, Torus, Material>),
}

macro_rules! each_leaf {
    ($leaf:expr, $object:ident => $use:expr) => {
        match $leaf {
            Leaf::Sphere($object) => $use,
            Leaf::Plane($object) => $use,
            Leaf::Cuboid($object) => $use,
            Leaf::Quadric($object) => $use,
            Leaf::Torus($object) => $use,
        }
    };
}

pub(crate) use each_leaf;

/// An expression over solids, as a file has it.
#[derive(Clone, Debug)]
pub struct Tree<'a> {
    /// In the order of the expression.
    pub leaves: Vec<Leaf<'a>>,
    /// Operands first.
    pub steps: &'a [Step],
}

impl Tree<'_> {
    /// The value of the expression, of leaves that are one of `T` each.
    pub fn fold<T>(
        steps: &[Step],
        mut leaf: impl FnMut(usize) -> T,
        mut join: impl FnMut(Step, T, T) -> T,
    ) -> Option<T> {
        let mut waiting = Vec::new();
        let mut leaves = 0;
        for &step in steps {
            let value = match step {
                Step::Leaf => {
                    leaves += 1;
                    leaf(leaves - 1)
                }
                operator => {
                    let (right, left) = (waiting.pop()?, waiting.pop()?);
                    join(operator, left, right)
                }
            };
            waiting.push(value);
        }
        waiting.pop()
    }
}

impl Expression for Tree<'_> {
    type Material = Material;
    const LEAVES: usize = limits::LEAVES;
    const CROSSINGS: usize = 4 * limits::LEAVES;

    fn leaves(&self) -> usize {
        self.leaves.len()
    }

    fn contains(&self, leaves: u32) -> bool {
        // Waiting values are bits: there are never more than leaves.
        let (mut waiting, mut leaf) = (0_u64, 0);
        for step in self.steps {
            if *step == Step::Leaf {
                waiting = waiting << 1 | u64::from(leaves >> leaf & 1);
                leaf += 1;
                continue;
            }
            let (right, left) = (waiting & 1, waiting >> 1 & 1);
            let value = match step {
                Step::Union => left | right,
                Step::Intersection => left & right,
                _ => left & !right,
            };
            waiting = waiting >> 2 << 1 | value;
        }
        waiting & 1 == 1
    }

    fn flips(&self, leaf: usize) -> bool {
        // For each part of the expression: whether it holds the leaf, and whether it takes it away.
        let found = Self::fold(
            self.steps,
            |it| (it == leaf, false),
            |step, left, right| {
                let taken = step == Step::Difference && right.0;
                (left.0 || right.0, left.1 != (right.1 != taken))
            },
        );
        found.is_some_and(|it| it.1)
    }

    fn cross<P: Math>(
        &self,
        ray: &Ray,
        leaving: Option<(usize, Side)>,
        visit: &mut impl FnMut(f32, usize),
    ) -> Crossed {
        let mut crossed = Crossed {
            inside: 0,
            any: false,
        };
        for (place, leaf) in self.leaves.iter().enumerate() {
            let side = leaving.and_then(|(left, side)| (left == place).then_some(side));
            let mut meet = |t| {
                crossed.any = true;
                visit(t, place);
            };
            let inside = each_leaf!(leaf, it => it.shape.cross::<P>(ray, side, &mut meet));
            crossed.inside |= u32::from(inside) << place;
        }
        crossed
    }

    fn uv(&self, point: Vec3, leaf: usize) -> (f32, f32) {
        match self.leaves.get(leaf) {
            Some(leaf) => each_leaf!(leaf, it => it.shape.uv(point)),
            None => (0.0, 0.0),
        }
    }

    fn surface<P: Math>(&self, ray: &Ray, t: f32, leaf: usize) -> Option<(Vec3, &Material)> {
        let leaf = self.leaves.get(leaf)?;
        Some(each_leaf!(leaf, it => (it.shape.normal::<P>(ray, t), it.material)))
    }
}

/// A solid of a scene file.
pub type HostSolid<'a> = Csg<Tree<'a>, { 4 * limits::LEAVES }>;

/// A group, placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Which group.
    pub group: usize,
    /// Where it is.
    pub placement: Placement,
    /// The place of its first object.
    pub first: usize,
}

/// Objects, and solids after them.
pub type Content<'s, G> = (G, Solids<'s>);

/// Some solids.
#[derive(Clone, Copy, Debug)]
pub struct Solids<'s>(pub &'s [HostSolid<'s>]);

/// All of a scene, `G` being its objects and those of each group.
#[derive(Debug)]
pub struct Whole<'s, G> {
    /// What is not placed.
    pub top: Content<'s, G>,
    /// What is.
    pub groups: Vec<Content<'s, G>>,
    /// In order.
    pub placed: &'s [Placed],
}

impl<'s> Solids<'s> {
    /// The solid that has an object as a leaf, and its first.
    fn holder(&self, object: usize, mut first: usize) -> Option<(&'s HostSolid<'s>, usize)> {
        for solid in self.0 {
            if object < first + solid.len() {
                return Some((solid, first));
            }
            first += solid.len();
        }
        None
    }
}

impl Geometry for Solids<'_> {
    type Material = Material;

    fn len(&self) -> usize {
        self.0.iter().map(Geometry::len).sum()
    }

    fn nearest<P: Math>(&self, ray: &mut Ray, mut first: usize, _: Candidates) -> Option<usize> {
        let mut nearest = None;
        for solid in self.0 {
            nearest = solid.nearest::<P>(ray, first, Candidates::ALL).or(nearest);
            first += solid.len();
        }
        nearest
    }

    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &Material)> {
        let (solid, first) = self.holder(object, first)?;
        solid.surface::<P>(ray, t, object, first)
    }

    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        match self.holder(object, first) {
            Some((solid, first)) => solid.uv(point, object, first),
            None => (0.0, 0.0),
        }
    }

    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        self.nearest::<P>(&mut { *ray }, first, among).is_some()
    }

    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        mut first: usize,
        _: Candidates,
        light: &mut L,
    ) -> bool {
        self.0.iter().any(|solid| {
            let at = first;
            first += solid.len();
            solid.absorbs::<P, L>(ray, at, Candidates::ALL, light)
        })
    }
}

impl<'s, G: Geometry<Material = Material>> Whole<'s, G> {
    /// An instance, and the place of its first object.
    fn instance(&self, placed: &Placed, first: usize) -> (Instance<'_, Content<'s, G>>, usize) {
        let (geometry, placement) = (&self.groups[placed.group], placed.placement);
        let instance = Instance {
            geometry,
            placement,
        };
        (instance, first + placed.first)
    }

    fn instances(
        &self,
        first: usize,
    ) -> impl Iterator<Item = (Instance<'_, Content<'s, G>>, usize)> {
        self.placed.iter().map(move |it| self.instance(it, first))
    }

    /// The instance that has an object.
    fn holder(&self, object: usize, first: usize) -> Option<(Instance<'_, Content<'s, G>>, usize)> {
        let after = self.placed.partition_point(|it| first + it.first <= object);
        Some(self.instance(self.placed.get(after.checked_sub(1)?)?, first))
    }
}

impl<G: Geometry<Material = Material>> Geometry for Whole<'_, G> {
    type Material = Material;

    fn len(&self) -> usize {
        match self.placed.last() {
            Some(last) => last.first + self.groups[last.group].len(),
            None => self.top.len(),
        }
    }

    fn nearest<P: Math>(&self, ray: &mut Ray, first: usize, among: Candidates) -> Option<usize> {
        let mut nearest = self.top.nearest::<P>(ray, first, among);
        for (instance, first) in self.instances(first) {
            nearest = instance.nearest::<P>(ray, first, among).or(nearest);
        }
        nearest
    }

    fn surface<P: Math>(
        &self,
        ray: &Ray,
        t: f32,
        object: usize,
        first: usize,
    ) -> Option<(Vec3, &Material)> {
        if object < first + self.top.len() {
            return self.top.surface::<P>(ray, t, object, first);
        }
        let (instance, first) = self.holder(object, first)?;
        instance.into_surface::<P>(ray, object, first)
    }

    fn uv(&self, point: Vec3, object: usize, first: usize) -> (f32, f32) {
        if object < first + self.top.len() {
            return self.top.uv(point, object, first);
        }
        match self.holder(object, first) {
            Some((instance, first)) => instance.uv(point, object, first),
            None => (0.0, 0.0),
        }
    }

    fn blocks<P: Math>(&self, ray: &Ray, first: usize, among: Candidates) -> bool {
        self.top.blocks::<P>(ray, first, among)
            || self
                .instances(first)
                .any(|(it, first)| it.blocks::<P>(ray, first, among))
    }

    fn absorbs<P: Math, L: Passage>(
        &self,
        ray: &Ray,
        first: usize,
        among: Candidates,
        light: &mut L,
    ) -> bool
    where
        Material: Finish,
    {
        self.top.absorbs::<P, L>(ray, first, among, light)
            || self
                .instances(first)
                .any(|(it, first)| it.absorbs::<P, L>(ray, first, among, light))
    }
}

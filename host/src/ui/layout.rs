//! Which views lie where: tabs that can be dragged, and what is remembered of them.

use clap::ValueEnum;
use egui_tiles::{
    Behavior, Container, Linear, LinearDir, SimplificationOptions, Tile, TileId, Tiles, Tree,
};
use serde::{Deserialize, Serialize};

use super::viewer::Views;
use crate::plot::View;

/// A view in a tab.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) enum Pane {
    Lit,
    Compare,
    Convergence,
    Plot(View),
    Sampling,
    Numerics,
    Environment,
    Editor,
}

impl Pane {
    /// All, in the order of the menu.
    pub(super) fn all() -> Vec<Self> {
        let mut all = vec![Self::Lit, Self::Compare, Self::Convergence];
        all.extend(View::value_variants().iter().map(|view| Self::Plot(*view)));
        all.extend([Self::Sampling, Self::Numerics, Self::Environment, Self::Editor]);
        all
    }

    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Lit => "Lit object",
            Self::Compare => "Compare",
            Self::Convergence => "Convergence",
            Self::Plot(View::Polar) => "Polar",
            Self::Plot(View::ThetaV) => "Theta v",
            Self::Plot(View::ThetaH) => "Theta h",
            Self::Plot(View::ThetaD) => "Theta d",
            Self::Plot(View::Albedo) => "Albedo",
            Self::Plot(View::Slice) => "Image slice",
            Self::Plot(View::Lobe) => "3D lobe",
            Self::Sampling => "Sampling",
            Self::Numerics => "Numerics",
            Self::Environment => "Environment",
            Self::Editor => "Editor",
        }
    }
}

/// The lit object on the left, lobe and plots over the slice on the right.
pub(super) fn usual() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut tabs = |panes: &[Pane]| {
        let children = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
        tiles.insert_tab_tile(children)
    };
    let lit = tabs(&[Pane::Lit, Pane::Compare, Pane::Environment, Pane::Convergence, Pane::Editor]);
    let above = [View::Polar, View::ThetaV, View::ThetaH, View::ThetaD, View::Albedo];
    let above = tabs(&above.map(Pane::Plot));
    let below = [Pane::Plot(View::Lobe), Pane::Plot(View::Slice), Pane::Sampling, Pane::Numerics];
    let below = tabs(&below);
    let mut column = Linear::new(LinearDir::Vertical, vec![above, below]);
    column.shares.set_share(above, 0.5);
    column.shares.set_share(below, 0.5);
    let column = tiles.insert_container(Container::Linear(column));
    let mut row = Linear::new(LinearDir::Horizontal, vec![lit, column]);
    row.shares.set_share(lit, 0.55);
    row.shares.set_share(column, 0.45);
    let root = tiles.insert_container(Container::Linear(row));
    Tree::new(egui::Id::unique("views"), root, tiles)
}

/// A layout that was written by [`to_text`]; none where it is none, or lacks the views.
pub(super) fn from_text(text: &str) -> Option<Tree<Pane>> {
    let tree: Tree<Pane> = serde_json::from_str(text).ok()?;
    let root = tree.root()?;
    tree.tiles.get(root)?;
    Some(tree)
}

pub(super) fn to_text(tree: &Tree<Pane>) -> String {
    serde_json::to_string(tree).unwrap_or_default()
}

/// Shows a view: its tab comes to the front, and one that was closed comes back.
pub(super) fn show(tree: &mut Tree<Pane>, pane: Pane) {
    let id = match tree.tiles.find_pane(&pane) {
        Some(id) => id,
        None => {
            let id = tree.tiles.insert_pane(pane);
            let tabs = tree.tiles.tile_ids().find(|id| {
                matches!(tree.tiles.get(*id), Some(Tile::Container(Container::Tabs(_))))
            });
            match tabs.or(tree.root()) {
                Some(parent) => tree.move_tile_to_container(id, parent, usize::MAX, true),
                None => tree.root = Some(tree.tiles.insert_tab_tile(vec![id])),
            }
            id
        }
    };
    tree.make_active(|tile, _| tile == id);
}

/// Draws the views for the tree.
impl Behavior<Pane> for Views<'_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _: TileId, pane: &mut Pane) -> egui_tiles::UiResponse {
        egui::Frame::central_panel(ui.style()).inner_margin(6.0).show(ui, |ui| {
            // The ground reaches to the edges, also of a view that has nothing to show yet.
            ui.set_min_size(ui.available_size());
            self.view_ui(ui, *pane);
        });
        egui_tiles::UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        pane.title().into()
    }

    fn is_tab_closable(&self, _: &Tiles<Pane>, _: TileId) -> bool {
        true
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..Default::default() }
    }
}

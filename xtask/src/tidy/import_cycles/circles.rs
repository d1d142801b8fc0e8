//! Strongly connected components of a small directed graph.

/// Lists the sets of more than one node that reach each other; nodes ascend.
pub(super) fn circles(nodes: usize, edges: impl Iterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut next = vec![Vec::new(); nodes];
    edges.for_each(|(from, to)| next[from].push(to));
    let reached: Vec<Vec<bool>> = (0..nodes).map(|start| reachable(&next, start)).collect();
    let mut found: Vec<Vec<usize>> = Vec::new();
    for node in 0..nodes {
        let circle: Vec<usize> =
            (0..nodes).filter(|other| reached[node][*other] && reached[*other][node]).collect();
        if circle.len() > 1 && circle[0] == node {
            found.push(circle);
        }
    }
    found
}

/// Nodes that a path of at least one edge leads to.
fn reachable(next: &[Vec<usize>], start: usize) -> Vec<bool> {
    let mut reached = vec![false; next.len()];
    let mut open = vec![start];
    while let Some(node) = open.pop() {
        for &to in &next[node] {
            if !std::mem::replace(&mut reached[to], true) {
                open.push(to);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_of_more_than_one_node_are_found() {
        let edges = [(0, 1), (1, 2), (2, 1), (3, 3), (4, 5), (5, 6), (6, 4), (2, 4)];
        assert_eq!(circles(7, edges.into_iter()), [vec![1, 2], vec![4, 5, 6]]);
    }
}

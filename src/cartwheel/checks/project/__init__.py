"""How a project uses the checks: settings, suppressions, baselines, fixes and workspaces."""

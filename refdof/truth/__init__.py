"""Truth: reference pictures with error bars."""

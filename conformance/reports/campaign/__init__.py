"""Report on a campaign, from campaign.json."""
